// From patterns on a display to rows in the file, against the rows that the simulated eye has.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/estimate/status_limits.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/firmware/true_rows.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

/// A whole session into `file`, and its estimate.
calib::ResponseEstimate calibrated(const Board& board, const CalibrationRequest& request, calib::EyeFile& file) {
  SimulatedBench bench = SimulatedBench::create(board, test::real_display(board), 1).value();
  const std::int64_t id =
      run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, file, [](const calib::SessionProgress&) {
        return true;
      }).value();
  const calib::StoredSession session = file.sessions().value().front();
  CHECK(session.id == id);
  SessionEstimate made =
      estimate_session(file, session, {1.0 / board.source.frame_rate_hz, 1.0 / board.sensor.lsb(), "test", 0, 1})
          .value();
  CHECK(made.id == 1);
  CHECK(made.sensor.median.dark_noise_lsb.value() == doctest::Approx(1.04).epsilon(0.1));
  return std::move(made.rows);
}

}  // namespace

TEST_CASE("a session measures rows that no model of ours contains, and knows how well") {
  Board board = test::built_board();
  if (test::sanitized) board.object.rows = board.object.cols = 8;
  const std::vector<double> truth = test::true_rows(board);

  CalibrationRequest request = test::short_session(test::sanitized ? 24 : 128);
  request.plan.warm_up_s = 1.0;
  request.plan.dark_frames = request.plan.black_frames = request.plan.flat_frames = 32;
  request.plan.ramp_steps = 4;
  request.plan.ramp_frames = 16;
  const test::TemporaryFolder folder;
  auto file = calib::EyeFile::create((folder.path() / "a.eye").string(), {board.source.serial, board.eye, board.object})
                  .value();
  const calib::ResponseEstimate found = calibrated(board, request, file);

  const auto judgement = test::judged(found, truth, static_cast<std::size_t>(board.object.pixels()));
  CHECK(judgement.rows >= 60);
  CHECK(found.black_level == doctest::Approx(0.004).epsilon(0.2));
  if (!test::sanitized) {
    CHECK(judgement.error <= 0.006);
    CHECK(judgement.within_one >= 0.6);
    CHECK(judgement.within_one <= 0.75);
    CHECK(judgement.within_two >= 0.9);
  }

  const calib::Estimate record = file.load_estimate(1).value();
  REQUIRE(record.dark_level_lsb.size() == found.rows.size());
  for (const double dark : record.dark_level_lsb) {
    CHECK(dark == doctest::Approx(board.sensor.dark_level_lsb).epsilon(0.3));  // its spread and the bow are in it
  }
  CHECK(record.linearity_values.size() == record.linearity_codes.size() * found.rows.size());
  CHECK(record.status.size() == found.rows.size());
  const auto stored = file.load_response(1).value();
  const recon::Response response = found.response(board.object).value();
  CHECK(std::ranges::equal(stored.response.row_start(), response.row_start()));
  CHECK(std::ranges::equal(stored.response.columns(), response.columns()));
  CHECK(std::ranges::equal(stored.response.values(), response.values()));
}
