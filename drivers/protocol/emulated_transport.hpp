#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/protocol/device_emulator.hpp"
#include "hal/byte_transport.hpp"
#include "hal/clock.hpp"

namespace compueye::protocol {

/// The emulator behind the interface of a real transport, on either bus; its errors are those of one: not_found
/// (nothing plugged in at open()), disconnected, timeout, io (a stall), usage (not open).
///
/// Waiting sleeps on the clock until the device has something or the deadline has come, so that under a VirtualClock
/// time goes exactly as far as it must. A request takes `control_ns`.
class EmulatedTransport final : public hal::ByteTransport {
 public:
  static constexpr std::int64_t control_ns = 250'000;

  /// Both must outlive the transport.
  EmulatedTransport(DeviceEmulator& device, hal::Clock& clock);

  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return description_; }
  /// Resets the bus and takes hold of what is plugged in now; describe().serial is then its serial.
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override { attachment_ = 0; }
  /// USB: all that is ready, up to into.size(). HID: one report of 64 bytes a call.
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override;
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override;

 private:
  [[nodiscard]] hal::Result<void> check_there();
  [[nodiscard]] hal::Result<std::size_t> outcome(DeviceEmulator::Transfer transfer, const char* what,
                                                 std::int64_t deadline_ns);
  [[nodiscard]] hal::Result<std::size_t> feature_reports(std::uint8_t request, std::span<const std::byte> payload,
                                                         std::span<std::byte> reply, std::int64_t deadline_ns);
  [[nodiscard]] tl::unexpected<hal::Error> wait_in_vain(std::int64_t deadline_ns);
  [[nodiscard]] tl::unexpected<hal::Error> gone() const;

  DeviceEmulator& device_;
  hal::Clock& clock_;
  hal::TransportDescription description_;
  std::uint64_t attachment_ = 0;  // 0: not open
};

}  // namespace compueye::protocol
