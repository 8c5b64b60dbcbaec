#include "drivers/transport/usb_eye_list.hpp"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <utility>

#include "drivers/transport/usb_error.hpp"
#include "hal/try.hpp"

namespace compueye::transport {
namespace {

struct CloseHandle {
  void operator()(libusb_device_handle* handle) const noexcept { libusb_close(handle); }
};
using Handle = std::unique_ptr<libusb_device_handle, CloseHandle>;

std::string bus_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::string bus = "usb " + std::to_string(libusb_get_bus_number(device));
  for (int k = 0; k < count; ++k) bus += (k == 0 ? "-" : ".") + std::to_string(ports[static_cast<std::size_t>(k)]);
  return bus;
}

std::string path_of(libusb_device* device) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "/dev/bus/usb/%03u/%03u",
                static_cast<unsigned>(libusb_get_bus_number(device)),
                static_cast<unsigned>(libusb_get_device_address(device)));
  return text.data();
}

constexpr std::size_t most_text = 126;  // characters of a string descriptor

/// What Linux noted of the device when it came, "serial" or "product"; empty where there is no such note.
std::string noted_text(const std::string& bus, const char* name) {
  std::ifstream file("/sys/bus/usb/devices/" + bus.substr(bus.find(' ') + 1) + "/" + name);
  std::string text(most_text, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  text.resize(std::min(text.size(), text.find('\n')));
  return text;
}

/// Empty when the device has none or does not answer.
std::string asked_text(libusb_device_handle* handle, std::uint8_t index) {
  if (index == 0) return {};
  std::array<unsigned char, 2 * most_text> text{};
  const int bytes = libusb_get_string_descriptor_ascii(handle, index, text.data(), static_cast<int>(text.size()));
  return bytes <= 0 ? std::string() : std::string(text.begin(), text.begin() + bytes);
}

/// Opens `device` and fills in who it is. An eye that cannot be opened has the reason.
Handle look_at(libusb_device* device, const libusb_device_descriptor& descriptor, FoundEye& eye) {
  eye.bus = bus_of(device);
  eye.path = path_of(device);
  eye.serial = noted_text(eye.bus, "serial");
  eye.product = noted_text(eye.bus, "product");
  libusb_device_handle* handle = nullptr;
  if (const int code = libusb_open(device, &handle); code != LIBUSB_SUCCESS) {
    eye.refusal = usb_error(code, eye.bus, "opening the eye (" + eye.path + ")");
    return nullptr;
  }
  Handle opened(handle);
  if (eye.serial.empty()) eye.serial = asked_text(handle, descriptor.iSerialNumber);
  if (eye.product.empty()) eye.product = asked_text(handle, descriptor.iProduct);
  return opened;
}

/// Calls use(handle or null, eye) for every eye until it returns true.
template <class Use>
hal::Result<void> for_each_eye(libusb_context* context, protocol::UsbIdentity identity, Use&& use) {
  libusb_device** devices = nullptr;
  const auto count = libusb_get_device_list(context, &devices);
  if (count < 0) return tl::unexpected(usb_error(static_cast<int>(count), "usb", "listing the devices"));
  const std::unique_ptr<libusb_device*, void (*)(libusb_device**)> list(
      devices, [](libusb_device** those) { libusb_free_device_list(those, 1); });
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[k], &descriptor) != LIBUSB_SUCCESS) continue;
    if (descriptor.idVendor != identity.vendor || descriptor.idProduct != identity.product) continue;
    FoundEye eye;
    Handle handle = look_at(devices[k], descriptor, eye);
    if (use(std::move(handle), std::move(eye))) break;
  }
  return {};
}

}  // namespace

hal::Result<std::vector<FoundEye>> list_usb_eyes(protocol::UsbIdentity identity) {
  libusb_context* made = nullptr;
  if (const int code = libusb_init(&made); code != LIBUSB_SUCCESS) {
    return tl::unexpected(usb_error(code, "usb", "starting libusb"));
  }
  const std::unique_ptr<libusb_context, void (*)(libusb_context*)> context(made, libusb_exit);
  std::vector<FoundEye> eyes;
  TRY(for_each_eye(made, identity, [&](Handle, FoundEye eye) {
    eyes.push_back(std::move(eye));
    return false;
  }));
  std::sort(eyes.begin(), eyes.end(), [](const FoundEye& a, const FoundEye& b) { return a.bus < b.bus; });
  return eyes;
}

hal::Result<OpenedUsbEye> open_usb_eye(libusb_context* context, protocol::UsbIdentity identity,
                                       const std::string& serial) {
  OpenedUsbEye found;
  hal::Error refusal;
  std::vector<FoundEye> others;
  TRY(for_each_eye(context, identity, [&](Handle handle, FoundEye eye) {
    // One that may not be opened and whose serial nobody knows could be the one asked for.
    const bool could_be = serial.empty() || eye.serial == serial || (eye.serial.empty() && !eye.reachable());
    if (!could_be) {
      others.push_back(std::move(eye));
    } else if (!eye.reachable()) {
      if (refusal.place.empty()) refusal = eye.refusal;
    } else {
      found = {handle.release(), std::move(eye)};
    }
    return found.handle != nullptr;
  }));
  if (found.handle != nullptr) return found;
  if (!refusal.place.empty()) return tl::unexpected(std::move(refusal));
  return tl::unexpected(no_eye(protocol::usb_bus, serial, others));
}

}  // namespace compueye::transport
