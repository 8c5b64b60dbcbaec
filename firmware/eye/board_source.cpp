#include "firmware/eye/board_source.hpp"

#include <fmt/format.h>

#include <utility>

#include "drivers/device/device_source.hpp"
#include "drivers/transport/hid_hidapi.hpp"
#include "drivers/transport/usb_libusb.hpp"
#include "firmware/eye/simulated_board.hpp"

namespace compueye::firmware {
namespace {

using Source = std::unique_ptr<hal::SampleSource>;

hal::Result<Source> simulated(const Board& board, EyeWanted wanted, hal::Clock& clock) {
  auto settings = simulated_eye_settings(board, std::move(wanted.scene), wanted.seed);
  if (!wanted.lossless) settings.frame_rate_hz = board.source.frame_rate_hz;
  settings.frame_limit = wanted.frame_limit;
  auto eye = sim::SimulatedEye::create(std::move(settings), clock);
  if (!eye) return tl::unexpected(std::move(eye.error()));
  return Source(std::move(*eye));
}

template <class Transport, class Settings>
std::unique_ptr<hal::ByteTransport> cable_to(const std::string& serial) {
  Settings settings;
  settings.serial = serial;
  return std::make_unique<Transport>(std::move(settings));
}

hal::Result<Source> on_cable(const Board& board, hal::Clock& clock) {
  const bool hid = board.source.kind == "hid";
  device::DeviceSettings settings;
  settings.bus = hid ? device::DeviceBus::hid : device::DeviceBus::usb;
  settings.serial = board.source.serial;
  settings.frame_rate_hz = board.source.frame_rate_hz;
  auto cable = hid ? cable_to<transport::HidTransport, transport::HidSettings>(settings.serial)
                   : cable_to<transport::UsbTransport, transport::UsbSettings>(settings.serial);
  auto eye = device::DeviceSource::create(std::move(settings), std::move(cable), clock);
  if (!eye) return tl::unexpected(std::move(eye.error()));
  if (auto fits = check_fits((*eye)->describe(), board, "eye " + (*eye)->describe().serial); !fits) {
    return tl::unexpected(std::move(fits.error()));
  }
  return Source(std::move(*eye));
}

}  // namespace

hal::Result<Source> board_source(const Board& board, EyeWanted wanted, hal::Clock& clock) {
  if (board.source.simulated()) return simulated(board, std::move(wanted), clock);
  if (wanted.lossless) {
    return hal::fail(hal::ErrorCode::usage, "--lossless",
                     fmt::format("cannot be asked of the eye of board {}, which waits for nobody; record it and replay "
                                 "the recording",
                                 board.name));
  }
  return on_cable(board, clock);
}

hal::Result<void> check_fits(const hal::SourceDescription& source, const Board& board, const std::string& place) {
  if (source.channels == board.eye.ommatidia() && source.bits == board.sensor.bits) return {};
  return hal::fail(hal::ErrorCode::mismatch, place,
                   fmt::format("is of {} channels of {} bits, board {} has {} of {}; name the board that belongs to it",
                               source.channels, source.bits, board.name, board.eye.ommatidia(), board.sensor.bits));
}

}  // namespace compueye::firmware
