#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hal/result.hpp"

namespace compueye::hal {

/// What is at the other end of a transport.
struct TransportDescription {
  std::string bus;             ///< "usb 1-4", "hidraw2", "spidev0.0", "emulator"
  std::string serial;          ///< empty where the bus has none
  std::size_t max_packet = 0;  ///< bytes; reads should be multiples of it
};

/// Moves bytes and nothing else: no framing, no knowledge of the protocol above it. One thread reads, one writes.
class ByteTransport {
 public:
  ByteTransport() = default;
  ByteTransport(const ByteTransport&) = delete;
  ByteTransport& operator=(const ByteTransport&) = delete;
  virtual ~ByteTransport() = default;

  [[nodiscard]] virtual const TransportDescription& describe() const noexcept = 0;
  [[nodiscard]] virtual Result<void> open() = 0;
  virtual void close() noexcept = 0;

  /// Reads up to `into.size()` bytes of the stream. Errors: timeout (usable afterwards), disconnected, io.
  [[nodiscard]] virtual Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) = 0;

  /// Writes all of `from` or fails. The protocol of eyes has no stream towards the device: error unsupported.
  [[nodiscard]] virtual Result<void> write(std::span<const std::byte> from, std::int64_t /*deadline_ns*/) {
    return fail(ErrorCode::unsupported, describe().serial,
                "an eye takes no stream of bytes (" + std::to_string(from.size()) + " given); use control()");
  }

  /// One request on the control channel (USB EP0, HID feature report): towards the device when `reply` is empty, from
  /// it otherwise; returns the bytes received into `reply`. Errors: timeout, disconnected, io (the device refused it).
  [[nodiscard]] virtual Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                    std::span<std::byte> reply, std::int64_t deadline_ns) = 0;
};

}  // namespace compueye::hal
