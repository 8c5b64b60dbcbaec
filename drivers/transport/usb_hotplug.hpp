#pragma once

#include <cstdint>
#include <memory>

#include "drivers/protocol/usb_identity.hpp"
#include "hal/result.hpp"

namespace compueye::transport {

enum class HotplugMethod : std::uint8_t {
  automatic,  ///< events where libusb has them, else polling
  event,
  polling,
};

/// Tells when eyes may have come or gone. It only says "look again": libusb may report a device that was there already
/// twice (once found, once announced), and its callback may not open devices, so what is there is for list_usb_eyes()
/// or open() to find out.
class UsbHotplug {
 public:
  struct Settings {
    protocol::UsbIdentity identity = protocol::usb_eye_identity;
    HotplugMethod method = HotplugMethod::automatic;
    std::int64_t poll_ns = 250'000'000;  ///< how often polling looks
  };
  /// Errors: unsupported (events asked for that this libusb does not have), io.
  [[nodiscard]] static hal::Result<std::unique_ptr<UsbHotplug>> start(Settings settings);
  virtual ~UsbHotplug() = default;
  UsbHotplug(const UsbHotplug&) = delete;
  UsbHotplug& operator=(const UsbHotplug&) = delete;

  /// Waits until something may have changed since the call before, or the deadline: whether it may. One thread.
  [[nodiscard]] virtual bool wait(std::int64_t deadline_ns) = 0;
  [[nodiscard]] virtual HotplugMethod method() const noexcept = 0;

 protected:
  UsbHotplug() = default;
};

}  // namespace compueye::transport
