#pragma once

#include <string>
#include <vector>

#include "drivers/protocol/bus.hpp"
#include "drivers/transport/cable.hpp"
#include "hal/result.hpp"

struct libusb_context;
struct libusb_device_handle;

namespace compueye::transport {

/// As Cable::list().
[[nodiscard]] hal::Result<std::vector<FoundEye>> list_usb_eyes(
    protocol::UsbIdentity identity = protocol::usb_bus.identity);

/// For usb_libusb.cpp: opens the eye with this serial, or with an empty one the first. An eye whose requests hang is
/// found too, by what the system noted, so that a reset can cure it. Errors: not_found (names the serials that are
/// there), io (it is there and may not be opened).
struct OpenedUsbEye {
  libusb_device_handle* handle = nullptr;
  FoundEye eye;
};
[[nodiscard]] hal::Result<OpenedUsbEye> open_usb_eye(libusb_context* context, protocol::UsbIdentity identity,
                                                     const std::string& serial);

}  // namespace compueye::transport
