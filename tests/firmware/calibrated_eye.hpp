#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <string>

#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/eye_check.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

namespace compueye::test {

/// A session of a built eye in a file, once for all tests.
class CalibratedEye {
 public:
  CalibratedEye() {
    board_.sensor.bits = 12;
    board_.sensor.full_scale = 64.0;
    firmware::CalibrationRequest request = short_session(32);
    request.plan.dark_frames = request.plan.black_frames = request.plan.flat_frames = 32;
    request.plan.ramp_steps = 0;
    const auto bench = firmware::SimulatedBench::create(board_, firmware::plain_display(board_), 1).value();
    const auto go_on = [](const calib::SessionProgress&) { return true; };
    const std::int64_t id =
        firmware::run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, file_, go_on).value();
    CHECK(
        firmware::estimate_session(file_, file_.sessions().value().front(), {exposure_s(), unit_lsb(), "test", 0, 1}));
    CHECK(id == 1);
  }

  [[nodiscard]] static const CalibratedEye& once() {
    static const CalibratedEye eye;
    return eye;
  }

  [[nodiscard]] double exposure_s() const { return 1.0 / board_.source.frame_rate_hz; }
  [[nodiscard]] double unit_lsb() const { return 1.0 / board_.sensor.lsb(); }
  [[nodiscard]] firmware::EyeCheck check() const {
    return firmware::EyeCheck::create(file_, board_.object.distance_mm, exposure_s(), unit_lsb()).value();
  }
  [[nodiscard]] const calib::EyeFile& file() const { return file_; }
  [[nodiscard]] const firmware::Board& board() const { return board_; }

 private:
  firmware::Board board_ = firmware::load_board(source_path("boards/sim-8x8-built")).value();
  TemporaryFolder folder_;
  calib::EyeFile file_ =
      calib::EyeFile::create((folder_.path() / "a.eye").string(), {board_.source.serial, board_.eye, board_.object})
          .value();
};

}  // namespace compueye::test
