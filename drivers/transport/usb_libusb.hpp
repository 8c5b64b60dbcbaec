#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/protocol/bus.hpp"
#include "drivers/transport/cable.hpp"
#include "drivers/transport/usb_eye_list.hpp"
#include "drivers/transport/usb_transfer_ring.hpp"
#include "hal/byte_transport.hpp"

namespace compueye::transport {

struct UsbSettings {
  static constexpr int least_transfers = 8, most_transfers = 32;
  /// Linux gives all programs together so much for transfers (usbfs_memory_mb = 16).
  static constexpr std::size_t in_flight_limit = std::size_t{16} << 20U;

  protocol::UsbIdentity identity = protocol::usb_bus.identity;
  std::string serial;  ///< empty: the first eye that is found
  int transfers = 32;  ///< in flight, 8 .. 32
  /// Rounded up to whole packets of the endpoint. Up to 16 KiB, a transfer is one request to every host controller;
  /// libusb cuts larger ones for old controllers, and 1.0.26 handles an overflow in the middle of one badly.
  std::size_t transfer_bytes = std::size_t{16} << 10U;
  std::size_t most_in_flight_bytes = std::size_t{8} << 20U;  ///< transfers * transfer_bytes at most; below 16 MiB
};

/// An eye on USB through libusb: control() is vendor requests on EP0 (protocol/requests.hpp), read() the first bulk-in
/// endpoint of its vendor interface.
///
/// open() resets the device, which stops a stream and clears both its ends. A successful RESET_PIPES also clears the
/// host's end: what was under way is forgotten and a halt is over. read() and control() may be called from two threads;
/// open() and close() only when neither is under way. After open(), read() does not allocate except for the words of
/// an `io` or `disconnected`; libusb allocates for submissions, on the thread of the ring, and for control(), on the
/// caller's.
///
/// Once unplugged, read() still returns what came before, then `disconnected`. Plugged in again: open() again.
class UsbTransport final : public hal::ByteTransport {
 public:
  explicit UsbTransport(UsbSettings settings = {});
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;
  ~UsbTransport() override;

  /// Bus and serial after open(); max_packet of the endpoint.
  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return description_; }
  /// Errors: out_of_range (settings), not_found, io (permission, another program), no_space (kernel memory),
  /// unsupported (a device without the endpoint), disconnected.
  [[nodiscard]] hal::Result<void> open() override;
  void close() noexcept override;
  [[nodiscard]] hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override;
  /// Times out in whole milliseconds, at least 1.
  [[nodiscard]] hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload,
                                                 std::span<std::byte> reply, std::int64_t deadline_ns) override;

  /// Of the stream since open().
  [[nodiscard]] UsbStreamCounters counters() const;

 private:
  struct Connection;
  [[nodiscard]] hal::Result<void> connect(Connection& connection);
  [[nodiscard]] hal::Error not_open() const;

  UsbSettings settings_;
  hal::TransportDescription description_;
  std::unique_ptr<Connection> connection_;
};

extern const Cable usb_cable;

}  // namespace compueye::transport
