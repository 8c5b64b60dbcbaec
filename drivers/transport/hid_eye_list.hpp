#pragma once

#include <string>
#include <vector>

#include "drivers/protocol/usb_identity.hpp"
#include "hal/result.hpp"

namespace compueye::transport {

/// An eye found on HID. Firmware and ommatidia come out of its descriptor, by control() of an open transport.
struct HidEye {
  std::string bus;   ///< "hidraw2"
  std::string path;  ///< of the device file
  std::string serial;
  std::string product;
  bool reachable = false;  ///< this user may read and write the device file
};

/// What is attached now, ordered by bus, asked afresh of udev each time. Nothing is opened. Error io: hidapi cannot
/// look.
[[nodiscard]] hal::Result<std::vector<HidEye>> list_hid_eyes(
    protocol::UsbIdentity identity = protocol::hid_eye_identity);

/// The eye with this serial, or with an empty one the first. Errors: not_found (names the serials that are there), io
/// (it is there and may not be opened).
[[nodiscard]] hal::Result<HidEye> find_hid_eye(protocol::UsbIdentity identity, const std::string& serial);

}  // namespace compueye::transport
