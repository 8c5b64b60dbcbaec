#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/protocol/cobs.hpp"
#include "hal/byte_transport.hpp"

namespace compueye::transport {

/// An eye on a UART, or on whatever has its file: a pseudo-terminal or a socket. Packets,
/// requests and replies are COBS frames (docs/protocol.md, "UART"); packets that come while a reply is waited for are
/// kept for read(), up to a megabyte. One thread: there is one stream for both.
class UartTransport final : public hal::ByteTransport {
 public:
  /// `path`: of the device file. `baud`: bits a second, where the file is a terminal; one that the system knows.
  UartTransport(std::string path, int baud);
  /// Of a file that is open already, which becomes the transport's; open() then takes it as it is.
  UartTransport(int file, std::string name);
  UartTransport(const UartTransport&) = delete;
  UartTransport& operator=(const UartTransport&) = delete;
  ~UartTransport() override;

  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return description_; }
  /// Errors: not_found, io, usage (a rate that the system does not know).
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override;
  /// Whole packets, one behind the other, as on USB. Errors: timeout, disconnected (the file has ended), io.
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override;
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override;

 private:
  [[nodiscard]] hal::Result<void> set_up_terminal() const;
  [[nodiscard]] hal::Result<void> send_frame(std::span<const std::byte> frame, std::int64_t deadline_ns);
  [[nodiscard]] hal::Result<void> wait_for(short events, std::int64_t deadline_ns) const;
  /// Reads once and sorts what has come: packets, and replies to `reply_`.
  [[nodiscard]] hal::Result<void> take_more(std::int64_t deadline_ns);
  [[nodiscard]] hal::Error failure(int error, const char* doing) const;

  int file_ = -1;
  bool given_ = false;
  int baud_ = 0;
  hal::TransportDescription description_;
  std::vector<std::byte> chunk_;
  protocol::CobsDecoder decoder_;
  std::vector<std::byte> packets_;  // not yet read
  std::vector<std::byte> reply_;    // the last frame that was none
};

}  // namespace compueye::transport
