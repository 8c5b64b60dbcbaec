#include "firmware/app/devices/attached_eyes.hpp"

#include <memory>
#include <utility>

#include "drivers/device/device_source.hpp"
#include "drivers/transport/hid_eye_list.hpp"
#include "drivers/transport/hid_hidapi.hpp"
#include "drivers/transport/usb_eye_list.hpp"
#include "drivers/transport/usb_libusb.hpp"

namespace compueye::firmware {
namespace {

hal::Result<hal::SourceDescription> ask(device::DeviceBus bus, const std::string& serial,
                                        std::unique_ptr<hal::ByteTransport> cable, hal::Clock& clock) {
  device::DeviceSettings settings;
  settings.bus = bus;
  settings.serial = serial;
  settings.frame_rate_hz = 1.0;
  settings.start_limit_ns = 1'000'000'000;
  const auto eye = device::DeviceSource::create(std::move(settings), std::move(cable), clock);
  if (!eye) return tl::unexpected(eye.error());
  return (*eye)->describe();
}

void list_usb(hal::Clock& clock, AttachedEyes& found) {
  const auto eyes = transport::list_usb_eyes();
  if (!eyes) {
    found.notes.push_back(eyes.error().text());
    return;
  }
  for (const transport::UsbEye& eye : *eyes) {
    hal::Result<hal::SourceDescription> description = tl::unexpected(eye.refusal);
    if (eye.reachable()) {
      transport::UsbSettings settings;
      settings.serial = eye.serial;
      description = ask(device::DeviceBus::usb, eye.serial,
                        std::make_unique<transport::UsbTransport>(std::move(settings)), clock);
    }
    found.eyes.push_back({"usb", eye.bus, eye.serial, eye.product, std::move(description)});
  }
}

void list_hid(hal::Clock& clock, AttachedEyes& found) {
  const auto eyes = transport::list_hid_eyes();
  if (!eyes) {
    found.notes.push_back(eyes.error().text());
    return;
  }
  for (const transport::HidEye& eye : *eyes) {
    transport::HidSettings settings;
    settings.serial = eye.serial;
    found.eyes.push_back({"hid", eye.bus, eye.serial, eye.product,
                          ask(device::DeviceBus::hid, eye.serial,
                              std::make_unique<transport::HidTransport>(std::move(settings)), clock)});
  }
}

}  // namespace

AttachedEyes list_attached_eyes(hal::Clock& clock) {
  AttachedEyes found;
  list_usb(clock, found);
  list_hid(clock, found);
  return found;
}

}  // namespace compueye::firmware
