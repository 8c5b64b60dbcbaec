#pragma once

#include <cstdint>

namespace compueye::protocol {

/// How an eye names itself on USB: vendor and product of the device descriptor. Those of pid.codes for private tests;
/// an eye that is sold needs numbers of its own.
struct UsbIdentity {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
};

inline constexpr UsbIdentity usb_eye_identity{0x1209, 0x0001};  ///< vendor requests and one bulk-in endpoint
inline constexpr UsbIdentity hid_eye_identity{0x1209, 0x0002};  ///< a HID device with reports of 64 bytes

}  // namespace compueye::protocol
