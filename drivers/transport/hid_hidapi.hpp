#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/protocol/bus.hpp"
#include "drivers/transport/cable.hpp"
#include "hal/byte_transport.hpp"

namespace compueye::transport {

/// As Cable::list(), asked of udev.
[[nodiscard]] hal::Result<std::vector<FoundEye>> list_hid_eyes(
    protocol::UsbIdentity identity = protocol::hid_bus.identity);

struct HidSettings {
  protocol::UsbIdentity identity = protocol::hid_bus.identity;
  std::string serial;  ///< empty: the first eye that is found
};

/// An eye on HID through hidapi and the kernel's hidraw: control() is feature reports (protocol/hid_control.hpp),
/// read() one input report a call. The kernel queues 64 reports; it drops those for which there is no room, which the
/// frame numbers show. Nothing queues here, so there is no thread.
///
/// read() and control() may be called from two threads: each has a file of its own, because hidapi keeps the words of
/// an error with the file. open() and close() only when neither is under way. read() does not allocate, except for the
/// words of an `io` or `disconnected`.
///
/// The kernel gives a device that does not answer a request five seconds, and hidapi has no way to ask for less: then
/// control() comes back that late, with `timeout`.
class HidTransport final : public hal::ByteTransport {
 public:
  explicit HidTransport(HidSettings settings = {});
  HidTransport(const HidTransport&) = delete;
  HidTransport& operator=(const HidTransport&) = delete;
  ~HidTransport() override;

  /// Device file and serial after open(); max_packet is 64.
  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return description_; }
  /// Errors: not_found, io (permission).
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override;
  /// One report as the device sent it: 64 bytes, or fewer from a device that is wrong. `into` has room for 64. Times
  /// out in whole milliseconds. Errors: timeout, disconnected, io, usage (less room).
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override;
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override;

 private:
  struct Connection;
  [[nodiscard]] hal::Error failure(int error, const char* doing) const;
  [[nodiscard]] hal::Error not_open() const;

  HidSettings settings_;
  hal::TransportDescription description_;
  std::unique_ptr<Connection> connection_;
};

extern const Cable hid_cable;

}  // namespace compueye::transport
