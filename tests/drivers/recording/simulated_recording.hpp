#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <utility>

#include "drivers/recording/recording_source.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/simulated_eye.hpp"

/// A small simulated eye and recordings of it.
namespace compueye::recording::tests {

inline constexpr int eye_side = 4;

inline sim::SimulatedEyeSettings small_eye(double rate_hz = 100.0) {
  sim::SimulatedEyeSettings settings;
  settings.board.eye.rows = settings.board.eye.columns = eye_side;
  settings.board.eye.interommatidial_rad = 0.05;
  settings.board.eye.acceptance_rad = 0.14;
  settings.scenes.push_back(
      sim::scene_on(settings.board.object, "dots", sim::render_built_in("dots", 16, 16, 1).value()));
  settings.board.sensor = {.bits = 12, .full_scale = 64.0, .read_noise_lsb = 2.0, .dark_level_lsb = 20.0};
  settings.frame_rate_hz = rate_hz;
  settings.frame_limit = 60;
  settings.fifo_frames = 60;
  return settings;
}

/// Runs the eye through a RecordingSource until it ends, in virtual time. Returns the account it ended with.
inline hal::FrameAccount record(const sim::SimulatedEyeSettings& settings, const std::filesystem::path& path) {
  hal::VirtualClock clock(1'000'000'000);
  auto eye = sim::SimulatedEye::create(settings, clock).value();
  RecordingSettings recording;
  recording.path = path;
  recording.when_full = WhenFull::wait;
  auto source = RecordingSource::create(std::move(recording), *eye, clock).value();
  REQUIRE(source->start());
  while (source->read(clock.now_ns() + 1'000'000'000)) {
  }
  source->stop();
  REQUIRE_FALSE(source->error().has_value());
  CHECK(source->unrecorded() == 0);
  return source->account();
}

}  // namespace compueye::recording::tests
