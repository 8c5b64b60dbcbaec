#include "tests/hil/emulated_cable.hpp"

#include <linux/usb/ch9.h>

#include <algorithm>
#include <array>

namespace compueye::hil {
namespace {

using protocol::DeviceEmulator;
using protocol::Request;

constexpr std::uint8_t product_string = 2, serial_string = 3;
constexpr std::uint8_t bulk_in_address = 0x81;
constexpr std::uint16_t high_speed_packet = 512;

std::byte low(unsigned value) {
  return static_cast<std::byte>(value & 0xFFU);
}
std::byte high(unsigned value) {
  return static_cast<std::byte>(value >> 8U & 0xFFU);
}

}  // namespace

UsbDeviceModel::Transfer usb_transfer_of(DeviceEmulator::Transfer transfer) {
  using Outcome = UsbDeviceModel::Outcome;
  switch (transfer.outcome) {
    case DeviceEmulator::Outcome::done:
      return {Outcome::done, transfer.bytes};
    case DeviceEmulator::Outcome::nothing:
      return {Outcome::nothing, 0};
    case DeviceEmulator::Outcome::stalled:
      return {Outcome::stalled, 0};
    case DeviceEmulator::Outcome::gone:
      break;
  }
  return {Outcome::gone, 0};
}

std::vector<std::uint8_t> usb_string_descriptor(unsigned index, const std::string& serial) {
  std::vector<std::uint8_t> bytes{0, USB_DT_STRING};
  const std::string text = index == product_string ? "emulated eye" : index == serial_string ? serial : "";
  if (index == 0) {
    bytes.insert(bytes.end(), {0x09, 0x04});  // US English
  } else if (text.empty()) {
    return {};
  }
  for (const char c : text) bytes.insert(bytes.end(), {static_cast<std::uint8_t>(c), 0});
  bytes[0] = static_cast<std::uint8_t>(bytes.size());
  return bytes;
}

template <class Use>
UsbDeviceModel::Transfer EmulatedUsbEye::when_there(Use&& use) {
  return cable_.with([&](DeviceEmulator& device, std::int64_t now_ns) -> Transfer {
    if (!device.attached(now_ns) || device.attachment(now_ns) != attachment_) return {Outcome::gone, 0};
    return use(device, now_ns);
  });
}

UsbDeviceModel::Transfer EmulatedUsbEye::control(const Setup& setup, std::span<std::byte> data) {
  if ((setup.type & USB_TYPE_MASK) == USB_TYPE_STANDARD) return standard(setup, data);
  return when_there([&](DeviceEmulator& device, std::int64_t now_ns) {
    if ((setup.type & USB_DIR_IN) == 0) return usb_transfer_of(device.control(now_ns, setup.request, data, {}));
    const std::array payload{low(setup.value), high(setup.value), low(setup.index), high(setup.index)};
    const auto request = static_cast<Request>(setup.request);
    const bool has_payload = request == Request::get_desc || request == Request::ping;
    return usb_transfer_of(device.control(
        now_ns, setup.request, std::span<const std::byte>(payload).first(has_payload ? payload.size() : 0), data));
  });
}

UsbDeviceModel::Transfer EmulatedUsbEye::standard(const Setup& setup, std::span<std::byte> data) {
  const unsigned kind = setup.value >> 8U, index = setup.value & 0xFFU;
  if (setup.request != USB_REQ_GET_DESCRIPTOR || kind != USB_DT_STRING) return {Outcome::stalled, 0};
  return when_there([&](DeviceEmulator& device, std::int64_t now_ns) -> Transfer {
    // The emulator knows only requests of the protocol; a firmware that answers none answers this one neither.
    std::array<std::byte, 4> nonce{};
    std::array<std::byte, protocol::PingReply::bytes> reply{};
    const auto ping = device.control(now_ns, protocol::number(Request::ping), nonce, reply);
    if (ping.outcome == DeviceEmulator::Outcome::nothing) return {};
    const auto bytes = usb_string_descriptor(index, device.serial());
    if (bytes.empty()) return {Outcome::stalled, 0};
    const std::size_t count = std::min(bytes.size(), data.size());
    for (std::size_t k = 0; k < count; ++k) data[k] = std::byte{bytes[k]};
    return {Outcome::done, count};
  });
}

UsbDeviceModel::Transfer EmulatedUsbEye::read(std::span<std::byte> into) {
  return when_there(
      [&](DeviceEmulator& device, std::int64_t now_ns) { return usb_transfer_of(device.read(now_ns, into)); });
}

void EmulatedUsbEye::reset() {
  if (at_reset) at_reset();
  when_there([](DeviceEmulator& device, std::int64_t now_ns) {
    device.reset_bus(now_ns);
    return Transfer{};
  });
}

std::vector<std::uint8_t> usb_descriptors(std::uint16_t vendor, std::uint16_t product) {
  const auto l = [](unsigned v) { return static_cast<std::uint8_t>(v & 0xFFU); };
  const auto h = [](unsigned v) { return static_cast<std::uint8_t>(v >> 8U); };
  return {// device: USB 2.0, class by interface, EP0 of 64 bytes, version 1.0, strings 1, 2, 3, one configuration
          18, USB_DT_DEVICE, 0, 2, 0, 0, 0, 64, l(vendor), h(vendor), l(product), h(product), 0, 1, 1, product_string,
          serial_string, 1,
          // configuration 1: one interface, bus powered, 500 mA
          9, USB_DT_CONFIG, 9 + 9 + 7, 0, 1, 1, 0, 0x80, 250,
          // interface 0: of the vendor, one endpoint
          9, USB_DT_INTERFACE, 0, 0, 1, USB_CLASS_VENDOR_SPEC, 0, 0, 0,
          // bulk in
          7, USB_DT_ENDPOINT, bulk_in_address, USB_ENDPOINT_XFER_BULK, l(high_speed_packet), h(high_speed_packet), 0};
}

}  // namespace compueye::hil
