#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "hal/result.hpp"

struct libusb_device_handle;
struct libusb_transfer;

namespace compueye::transport {

/// Requests on the control endpoint of an open device, one at a time, in a transfer and a buffer made once. Somebody
/// else has to handle libusb's events (UsbTransferRing): libusb's own waiting would make the caller do it, and with it
/// the stream's work.
class UsbControl {
 public:
  struct Request {
    std::uint8_t type = 0;  ///< bmRequestType
    std::uint8_t number = 0;
    std::uint16_t value = 0, index = 0;
  };

  /// Error no_space.
  [[nodiscard]] static hal::Result<std::unique_ptr<UsbControl>> create(libusb_device_handle* handle);
  /// No transfer may be under way.
  ~UsbControl();
  UsbControl(const UsbControl&) = delete;
  UsbControl& operator=(const UsbControl&) = delete;

  /// Sends `out` (empty for a request towards the host), or receives up to into.size() bytes; at most 4096 of either.
  /// `timeout_ms` 1 or more. Returns the bytes transferred, or a LIBUSB_ERROR_....
  [[nodiscard]] int transfer(const Request& request, std::span<const std::byte> out, std::span<std::byte> into,
                             unsigned timeout_ms);

 private:
  UsbControl() = default;
  static void on_completion(libusb_transfer* transfer) noexcept;

  libusb_device_handle* handle_ = nullptr;
  libusb_transfer* transfer_ = nullptr;
  std::vector<unsigned char> buffer_;
  std::mutex one_at_a_time_;
  std::mutex mutex_;
  std::condition_variable finished_;
  bool under_way_ = false;
};

}  // namespace compueye::transport
