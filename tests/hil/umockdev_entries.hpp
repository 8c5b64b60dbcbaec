#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/protocol/bus.hpp"

namespace compueye::hil {

/// Bytes as umockdev's "H:" attributes want them.
[[nodiscard]] std::string hex_of(const std::vector<std::uint8_t>& bytes);

/// An eye on port `port` of USB bus 1 with device number `address` (1 .. 127), in umockdev's notation.
struct UsbEntry {
  int port = 4;
  int address = 1;
  protocol::UsbIdentity identity = protocol::usb_bus.identity;
  std::string serial = {};  ///< as Linux notes it; empty: it did not

  [[nodiscard]] std::string sys_path() const;     ///< "/sys/devices/..."
  [[nodiscard]] std::string device_file() const;  ///< "/dev/bus/usb/001/004"
  [[nodiscard]] std::string text() const;
};

/// A HID eye on port `port` of USB bus 1 with device file /dev/hidraw`number`: USB device, interface, HID device and
/// hidraw, parents first.
struct HidEntry {
  int port = 6;
  int number = 1;
  std::string serial = {};
  protocol::UsbIdentity identity = protocol::hid_bus.identity;

  [[nodiscard]] std::string name() const { return "hidraw" + std::to_string(number); }
  [[nodiscard]] std::vector<std::string> sys_paths() const;
  [[nodiscard]] std::vector<std::string> texts() const;
};

}  // namespace compueye::hil
