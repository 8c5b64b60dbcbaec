#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/protocol/usb_identity.hpp"
#include "hal/error.hpp"
#include "hal/result.hpp"

struct libusb_context;
struct libusb_device_handle;

namespace compueye::transport {

/// An eye found on USB. Firmware and ommatidia come out of its descriptor, by control() of an open transport.
struct UsbEye {
  std::string bus;      ///< "usb 1-4": bus and ports, the same after every plugging-in
  std::string address;  ///< "001/007": of the device file, another after every plugging-in
  std::string serial;   ///< as the system noted it when the eye came, else asked for; empty when neither worked
  std::string product;  ///< likewise
  hal::Error refusal;   ///< why it could not be opened; an empty place when it could
  [[nodiscard]] bool reachable() const noexcept { return refusal.place.empty(); }
};

/// What is attached now, ordered by bus; an eye that may not be opened is listed with the reason. Each call looks
/// afresh, so that it does not depend on hotplug events. Errors: io (no USB on this machine).
[[nodiscard]] hal::Result<std::vector<UsbEye>> list_usb_eyes(
    protocol::UsbIdentity identity = protocol::usb_eye_identity);

/// For usb_libusb.cpp: opens the eye with this serial, or with an empty one the first. An eye whose requests hang is
/// found too, by what the system noted, so that a reset can cure it. Errors: not_found (names the serials that are
/// there), io (it is there and may not be opened).
struct OpenedUsbEye {
  libusb_device_handle* handle = nullptr;
  UsbEye eye;
};
[[nodiscard]] hal::Result<OpenedUsbEye> open_usb_eye(libusb_context* context, protocol::UsbIdentity identity,
                                                     const std::string& serial);

}  // namespace compueye::transport
