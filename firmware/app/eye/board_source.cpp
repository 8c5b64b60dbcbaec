#include "firmware/app/eye/board_source.hpp"

#include <fmt/format.h>

#include <utility>

#include "drivers/device/device_source.hpp"
#include "drivers/transport/hid_hidapi.hpp"
#include "drivers/transport/usb_libusb.hpp"

namespace compueye::firmware {

hal::Result<std::unique_ptr<hal::SampleSource>> attached_eye(const Board& board, hal::Clock& clock) {
  device::DeviceSettings settings;
  settings.serial = board.source.serial;
  settings.frame_rate_hz = board.source.frame_rate_hz;
  std::unique_ptr<hal::ByteTransport> cable;
  if (board.source.kind == "usb") {
    transport::UsbSettings usb;
    usb.serial = board.source.serial;
    cable = std::make_unique<transport::UsbTransport>(usb);
  } else if (board.source.kind == "hid") {
    settings.bus = device::DeviceBus::hid;
    transport::HidSettings hid;
    hid.serial = board.source.serial;
    cable = std::make_unique<transport::HidTransport>(hid);
  } else {
    return hal::fail(hal::ErrorCode::usage, board.place("source", "kind"), "is no eye on a cable");
  }
  auto eye = device::DeviceSource::create(std::move(settings), std::move(cable), clock);
  if (!eye) return tl::unexpected(std::move(eye.error()));
  if (auto fits = check_fits((*eye)->describe(), board, "eye " + (*eye)->describe().serial); !fits) {
    return tl::unexpected(std::move(fits.error()));
  }
  return std::unique_ptr<hal::SampleSource>(std::move(*eye));
}

hal::Result<void> check_fits(const hal::SourceDescription& source, const Board& board, const std::string& place) {
  if (source.channels == board.eye.ommatidia() && source.bits == board.sensor.bits) return {};
  return hal::fail(hal::ErrorCode::mismatch, place,
                   fmt::format("is of {} channels of {} bits, board {} has {} of {}; name the board that belongs to it",
                               source.channels, source.bits, board.name, board.eye.ommatidia(), board.sensor.bits));
}

}  // namespace compueye::firmware
