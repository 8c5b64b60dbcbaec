#include "firmware/eye/source_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drivers/device/device_source.hpp"
#include "drivers/device/hang_proof_eye.hpp"
#include "drivers/transport/hid_hidapi.hpp"
#include "drivers/transport/usb_libusb.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/eye/planned_eye.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "firmware/eye/source_kinds.hpp"
#include "firmware/eye/wired_eye.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

/// A line a bus of protocol::buses.
constexpr std::array cables{&transport::usb_cable, &transport::hid_cable};
static_assert(cables.size() == protocol::buses.size());

const transport::Cable& cable_on(const protocol::Bus& bus) {
  return **std::find_if(cables.begin(), cables.end(), [&](const auto* cable) { return &cable->bus == &bus; });
}

hal::Result<BoardEye> simulated(const Board& board, EyeWanted wanted, hal::Clock& clock) {
  auto settings = simulated_eye_settings(board, std::move(wanted.scene), wanted.seed);
  if (!wanted.lossless) settings.frame_rate_hz = board.source.frame_rate_hz;
  settings.frame_limit = wanted.frame_limit;
  settings.display = std::move(wanted.display);
  auto eye = TRY(planned_eye(board, std::move(settings), clock, wanted.progress));
  sim::SimulatedEye* const at = eye.get();
  return BoardEye{std::move(eye), at, nullptr};
}

/// The eye on a cable of a board, exposed for as long as its rate allows.
hal::Result<std::unique_ptr<device::DeviceSource>> identified(const Board& board, hal::Clock& clock) {
  device::DeviceSettings settings;
  settings.bus = bus_of_kind(board.source.kind);
  settings.serial = board.source.serial;
  settings.frame_rate_hz = board.source.frame_rate_hz;
  auto transport = cable_on(*settings.bus).connect(settings.serial);
  auto eye = TRY(device::DeviceSource::create(std::move(settings), std::move(transport), clock));
  TRY(check_fits(eye->describe(), board, "eye " + eye->describe().serial));
  return eye;
}

/// Rows that were measured are of samples of their session's exposure.
hal::Result<BoardEye> as_measured(const Board& board) {
  const auto exposure_s = TRY(measured_exposure_s(board));
  if (exposure_s && *exposure_s * board.source.frame_rate_hz > 1.0 + 1e-9) {
    return hal::fail(
        hal::ErrorCode::mismatch, board.eye_path(),
        fmt::format("was measured with frames exposed for {:.4g} ms, which has no room at {:g} Hz; state a "
                    "rate of at most {:.6g} Hz, or calibrate at this one",
                    *exposure_s * 1e3, board.source.frame_rate_hz, 1.0 / *exposure_s));
  }
  auto eye = TRY(real_eye(board));
  if (exposure_s) TRY(eye.attached->set_exposure(std::llround(*exposure_s * 1e9)));
  return eye;
}

/// What an eye says of itself.
hal::Result<hal::SourceDescription> ask(const transport::Cable& cable, const transport::FoundEye& eye) {
  if (!eye.reachable()) return tl::unexpected(eye.refusal);
  device::DeviceSettings settings;
  settings.bus = &cable.bus;
  settings.serial = eye.serial;
  settings.frame_rate_hz = 1.0;
  settings.start_limit_ns = 1'000'000'000;
  const auto open = [&cable, settings](hal::Clock& clock) {
    return device::DeviceSource::create(settings, cable.connect(settings.serial), clock);
  };
  return TRY(device::HangProofEye::create(eye.serial, open))->describe();
}

}  // namespace

hal::Result<BoardEye> board_eye(const Board& board, EyeWanted wanted, hal::Clock& clock) {
  if (board.source.simulated()) return simulated(board, std::move(wanted), clock);
  if (wanted.lossless) {
    return hal::fail(hal::ErrorCode::usage, "--lossless",
                     fmt::format("cannot be asked of the eye of board {}, which waits for nobody; record it and replay "
                                 "the recording",
                                 board.name));
  }
  return board.source.wired() ? real_eye(board) : as_measured(board);
}

hal::Result<std::unique_ptr<hal::SampleSource>> board_source(const Board& board, EyeWanted wanted, hal::Clock& clock) {
  return TRY(board_eye(board, std::move(wanted), clock)).source;
}

/// What hangs in the driver of one keeps what it was made of.
hal::Result<BoardEye> real_eye(const Board& board) {
  const auto of = std::make_shared<const Board>(board);
  if (board.source.wired()) {
    auto eye = TRY(
        device::HangProofSource::create(board.wiring.data, [of](hal::Clock& clock) { return wired_eye(*of, clock); }));
    device::HangProofSource* const guard = eye.get();
    return BoardEye{std::move(eye), nullptr, nullptr, guard};
  }
  auto eye = TRY(device::HangProofEye::create(board.source.serial.empty() ? board.source.kind : board.source.serial,
                                              [of](hal::Clock& clock) { return identified(*of, clock); }));
  device::HangProofEye* const at = eye.get();
  return BoardEye{std::move(eye), nullptr, at, at};
}

hal::Result<void> check_fits(const hal::SourceDescription& source, const Board& board, const std::string& place) {
  if (source.channels == board.eye.ommatidia() && source.bits == board.sensor.bits) return {};
  return hal::fail(hal::ErrorCode::mismatch, place,
                   fmt::format("is of {} channels of {} bits, board {} has {} of {}; name the board that belongs to it",
                               source.channels, source.bits, board.name, board.eye.ommatidia(), board.sensor.bits));
}

std::unique_ptr<hal::ByteTransport> connect(const protocol::Bus& bus, const std::string& serial) {
  return cable_on(bus).connect(serial);
}

AttachedEyes list_attached_eyes() {
  AttachedEyes found;
  for (const transport::Cable* cable : cables) {
    const auto eyes = cable->list();
    if (!eyes) {
      found.notes.push_back(eyes.error().text());
      continue;
    }
    for (const transport::FoundEye& eye : *eyes) {
      found.eyes.push_back({std::string(cable->bus.name), eye.bus, eye.serial, eye.product, ask(*cable, eye)});
    }
  }
  return found;
}

}  // namespace compueye::firmware
