#pragma once

#include "firmware/calibration/calibration_run.hpp"
#include "firmware/eye/board.hpp"
#include "tests/source_folder.hpp"

namespace compueye::test {

/// A session as short as one can be that has every stage.
[[nodiscard]] inline firmware::CalibrationRequest short_session(int patterns) {
  firmware::CalibrationRequest request;
  request.plan.warm_up_s = 0.1;
  request.plan.settle_ms = 60.0;
  request.plan.dark_frames = request.plan.black_frames = request.plan.flat_frames = 2;
  request.plan.ramp_steps = 1;
  request.plan.ramp_frames = 2;
  request.plan.patterns = patterns;
  request.distance_mm = 30.0;
  request.configuration = "unchanged";
  request.program = "test";
  return request;
}

/// Of an eye without noise, so that a capture is the same whenever it is taken.
[[nodiscard]] inline firmware::Board quiet_board() {
  firmware::Board board = firmware::load_board(source_path("boards/sim-8x8")).value();
  board.sensor.read_noise_lsb = 0.0;
  return board;
}

}  // namespace compueye::test
