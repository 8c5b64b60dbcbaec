#include "tests/hil/umockdev_entries.hpp"

#include <cstdio>

#include "drivers/protocol/hid_report.hpp"
#include "tests/hil/emulated_cable.hpp"
#include "tests/hil/emulated_hidraw.hpp"

namespace compueye::hil {
namespace {

std::string padded(const char* format, unsigned value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string port_path(int port) {
  return "/sys/devices/pci0000:00/usb1/1-" + std::to_string(port);
}

/// umockdev's notation has paths without "/sys" and files without "/dev/".
std::string begin(const std::string& sys_path) {
  return "P: " + sys_path.substr(4) + "\n";
}

}  // namespace

std::string hex_of(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += padded("%02x", byte);
  return text;
}

std::string UsbEntry::sys_path() const {
  return port_path(port);
}

std::string UsbEntry::device_file() const {
  return "/dev/bus/usb/001/" + padded("%03u", static_cast<unsigned>(address));
}

std::string UsbEntry::text() const {
  return begin(sys_path()) + "N: " + device_file().substr(5) +
         "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM=" +
         padded("%03u", static_cast<unsigned>(address)) + "\nE: DEVNAME=" + device_file() +
         "\nE: MAJOR=189\nE: MINOR=" + std::to_string(address - 1) +
         "\nA: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=" + std::to_string(address) +
         "\\n\nA: speed=480\\n\n" +
         (serial.empty() ? "" : "A: product=emulated eye\\n\nA: serial=" + serial + "\\n\n") +
         "H: descriptors=" + hex_of(usb_descriptors(identity.vendor, identity.product)) + "\n";
}

std::vector<std::string> HidEntry::sys_paths() const {
  const std::string device = port_path(port), interface = device + "/1-" + std::to_string(port) + ":1.0";
  const std::string hid = interface + "/0003:" + padded("%04X", identity.vendor) + ":" +
                          padded("%04X", identity.product) + "." + padded("%04X", static_cast<unsigned>(number));
  return {device, interface, hid, hid + "/hidraw/" + name()};
}

std::vector<std::string> HidEntry::texts() const {
  const auto paths = sys_paths();
  const std::string minor = std::to_string(number), hid_name = paths[2].substr(paths[2].rfind('/') + 1);
  return {
      begin(paths[0]) + "E: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: product=emulated eye\\n\nA: serial=" + serial +
          "\\n\nA: bcdDevice=0100\\n\n",
      begin(paths[1]) + "E: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=00\\n\n",
      begin(paths[2]) + "E: SUBSYSTEM=hid\nE: HID_ID=0003:" + padded("%08X", identity.vendor) + ":" +
          padded("%08X", identity.product) + "\nE: HID_NAME=emulated eye\nE: HID_UNIQ=" + serial +
          "\nH: report_descriptor=" +
          hex_of({protocol::hid_report_descriptor.begin(), protocol::hid_report_descriptor.end()}) + "\n",
      // hidapi finds the HID device through the link.
      begin(paths[3]) + "N: " + name() + "\nE: SUBSYSTEM=hidraw\nE: DEVNAME=/dev/" + name() +
          "\nE: MAJOR=240\nE: MINOR=" + minor + "\nA: dev=240:" + minor + "\\n\nL: device=../../../" + hid_name + "\n",
  };
}

}  // namespace compueye::hil
