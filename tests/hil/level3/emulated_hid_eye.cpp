#include "tests/hil/level3/emulated_hid_eye.hpp"

#include <linux/hid.h>
#include <linux/usb/ch9.h>

#include <algorithm>
#include <array>

#include "drivers/protocol/hid_report.hpp"

namespace compueye::hil {
namespace {

using protocol::DeviceEmulator;
using Outcome = UsbDeviceModel::Outcome;
using Transfer = UsbDeviceModel::Transfer;

constexpr std::uint8_t hid_class = 3, hid_descriptor = 0x21, report_descriptor = 0x22;  // USB HID 1.11, 4.1 and 7.1
constexpr std::uint8_t interrupt_in_address = 0x81;
constexpr auto report_descriptor_bytes = static_cast<std::uint8_t>(protocol::hid_report_descriptor.size());

Transfer copied(std::span<const std::uint8_t> from, std::span<std::byte> into) {
  const std::size_t bytes = std::min(from.size(), into.size());
  for (std::size_t k = 0; k < bytes; ++k) into[k] = std::byte{from[k]};
  return {Outcome::done, bytes};
}

}  // namespace

template <class Use>
Transfer EmulatedHidEye::when_there(Use&& use) {
  return cable_.with([&](DeviceEmulator& device, std::int64_t now_ns) -> Transfer {
    if (!device.attached(now_ns) || device.attachment(now_ns) != attachment_) return {Outcome::gone, 0};
    return use(device, now_ns);
  });
}

Transfer EmulatedHidEye::control(const Setup& setup, std::span<std::byte> data) {
  if (setup.request == USB_REQ_GET_DESCRIPTOR && (setup.type & USB_TYPE_MASK) == USB_TYPE_STANDARD) {
    return descriptor(setup, data);
  }
  if ((setup.type & USB_TYPE_MASK) != USB_TYPE_CLASS) return {Outcome::stalled, 0};
  // 7.2: the report's type is in the high byte, its id in the low one.
  const auto id = static_cast<std::uint8_t>(setup.value & 0xFFU);
  const bool feature = setup.value >> 8U == HID_FEATURE_REPORT + 1U;
  if (setup.request == HID_REQ_SET_IDLE) return {Outcome::done, 0};
  if (setup.request == HID_REQ_SET_REPORT && feature) {
    return when_there(
        [&](DeviceEmulator& device, std::int64_t now_ns) { return usb_transfer_of(device.set_feature(now_ns, data)); });
  }
  if (setup.request == HID_REQ_GET_REPORT && feature) {
    return when_there([&](DeviceEmulator& device, std::int64_t now_ns) {
      return usb_transfer_of(device.get_feature(now_ns, id, data));
    });
  }
  return {Outcome::stalled, 0};
}

Transfer EmulatedHidEye::descriptor(const Setup& setup, std::span<std::byte> data) {
  const unsigned kind = setup.value >> 8U, index = setup.value & 0xFFU;
  if (kind == report_descriptor) return copied(protocol::hid_report_descriptor, data);
  if (kind != USB_DT_STRING) return {Outcome::stalled, 0};
  return when_there([&](DeviceEmulator& device, std::int64_t) -> Transfer {
    const auto text = usb_string_descriptor(index, device.serial());
    return text.empty() ? Transfer{Outcome::stalled, 0} : copied(text, data);
  });
}

Transfer EmulatedHidEye::read(std::span<std::byte> into) {
  return when_there(
      [&](DeviceEmulator& device, std::int64_t now_ns) { return usb_transfer_of(device.read(now_ns, into)); });
}

void EmulatedHidEye::reset() {
  when_there([](DeviceEmulator& device, std::int64_t now_ns) {
    device.reset_bus(now_ns);
    return Transfer{};
  });
}

std::vector<std::uint8_t> hid_descriptors(std::uint16_t vendor, std::uint16_t product) {
  std::vector<std::uint8_t> bytes = usb_descriptors(vendor, product);
  bytes.resize(bytes[0]);               // the device's is that of any eye
  constexpr std::uint8_t every_ms = 4;  // 2^(4-1) microframes
  const auto report = static_cast<std::uint8_t>(protocol::hid_report_bytes);
  bytes.insert(bytes.end(), {// configuration 1: one interface, bus powered, 500 mA
                             9, USB_DT_CONFIG, 9 + 9 + 9 + 7, 0, 1, 1, 0, 0x80, 250,
                             // interface 0: HID, one endpoint
                             9, USB_DT_INTERFACE, 0, 0, 1, hid_class, 0, 0, 0,
                             // HID 1.11, no country, one report descriptor
                             9, hid_descriptor, 0x11, 1, 0, 1, report_descriptor, report_descriptor_bytes, 0,
                             // interrupt in
                             7, USB_DT_ENDPOINT, interrupt_in_address, USB_ENDPOINT_XFER_INT, report, 0, every_ms});
  return bytes;
}

}  // namespace compueye::hil
