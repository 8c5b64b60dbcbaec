// From patterns on a display to rows in the file, against the rows that the simulated eye has.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/estimate/status_limits.hpp"
#include "calib/median.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/sanitized.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

/// What no parametric model has, and a converter of 12 bits.
Board built_board() {
  Board board = load_board(test::source_path("boards/sim-8x8-built")).value();
  board.sensor.bits = 12;
  board.sensor.full_scale = 64.0;
  board.detector.inl_lsb = 10.0;
  return board;
}

sim::Scene real_display(const Board& board) {
  sim::Scene scene = plain_display(board);
  scene.display.gamma = 2.2;
  scene.display.black_level = 0.004;
  scene.display.drift_per_hour = 0.5;
  return scene;
}

/// Row after row, by one white pixel after the other.
std::vector<double> true_rows(const Board& board) {
  SimulatedBench bench = SimulatedBench::create(board, plain_display(board), 1).value();
  const auto pixels = static_cast<std::size_t>(board.object.pixels());
  const auto channels = static_cast<std::size_t>(board.eye.ommatidia());
  std::vector<double> rows(channels * pixels);
  for (std::size_t n = 0; n < pixels; ++n) {
    hal::Image one(board.object.rows, board.object.cols, 0.0F);
    one.pixels[n] = 1.0F;
    REQUIRE(bench.eye->show(one, 0.0).has_value());
    const auto levels = bench.eye->levels_lsb(0);
    for (std::size_t m = 0; m < channels; ++m) rows[m * pixels + n] = levels[m];
  }
  REQUIRE(bench.eye->show(hal::Image(board.object.rows, board.object.cols, 0.0F), 0.0).has_value());
  const auto dark = bench.eye->levels_lsb(0);
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = (rows[k] - dark[k / pixels]) * board.sensor.lsb();
  return rows;
}

struct Judged {
  std::size_t rows = 0;
  double error = 0.0;       ///< relative, of the median row; the unit, a display's white that drifts, is taken off
  double within_one = 0.0;  ///< share of the entries within one stated sigma, and within two
  double within_two = 0.0;
};

/// What the true rows are times the found ones, all together.
double unit_of(const calib::ResponseEstimate& found, const std::vector<double>& truth, std::size_t pixels) {
  double product = 0.0, square = 0.0;
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    for (std::size_t k = 0; k < found.rows[m].columns.size(); ++k) {
      const auto value = static_cast<double>(found.rows[m].values[k]);
      product += value * truth[m * pixels + static_cast<std::size_t>(found.rows[m].columns[k])];
      square += value * value;
    }
  }
  return product / square;
}

Judged judged(const calib::ResponseEstimate& found, const std::vector<double>& truth, std::size_t pixels) {
  const double unit = unit_of(found, truth, pixels);
  std::vector<double> errors;
  double one = 0.0, two = 0.0, entries = 0.0;
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    const calib::RowEstimate& row = found.rows[m];
    if (row.status != hal::ChannelStatus::good) continue;
    const auto begin = truth.begin() + static_cast<std::ptrdiff_t>(m * pixels);
    std::vector<double> off(begin, begin + static_cast<std::ptrdiff_t>(pixels));
    double norm2 = 0.0, error2 = 0.0;
    for (const double t : off) norm2 += t * t;
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
      double& difference = off[static_cast<std::size_t>(row.columns[k])];
      difference -= unit * static_cast<double>(row.values[k]);
      const double deviations = std::fabs(difference) / static_cast<double>(row.sigmas[k]);
      one += deviations <= 1.0 ? 1.0 : 0.0;
      two += deviations <= 2.0 ? 1.0 : 0.0;
      entries += 1.0;
    }
    for (const double d : off) error2 += d * d;
    errors.push_back(std::sqrt(error2 / norm2));
  }
  return {errors.size(), calib::median(errors), one / entries, two / entries};
}

/// A whole session into `file`, and its estimate.
calib::ResponseEstimate calibrated(const Board& board, const CalibrationRequest& request, calib::EyeFile& file) {
  SimulatedBench bench = SimulatedBench::create(board, real_display(board), 1).value();
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
  Board board = built_board();
  if (test::sanitized) board.object.rows = board.object.cols = 8;
  Board quiet = board;
  quiet.sensor.read_noise_lsb = 0.0;
  quiet.detector.inl_lsb = 0.0;
  const std::vector<double> truth = true_rows(quiet);

  CalibrationRequest request = test::short_session(test::sanitized ? 24 : 128);
  request.plan.warm_up_s = 1.0;
  request.plan.dark_frames = request.plan.black_frames = request.plan.flat_frames = 32;
  request.plan.ramp_steps = 4;
  request.plan.ramp_frames = 16;
  const test::TemporaryFolder folder;
  auto file = calib::EyeFile::create((folder.path() / "a.eye").string(), {board.source.serial, board.eye, board.object})
                  .value();
  const calib::ResponseEstimate found = calibrated(board, request, file);

  const auto judgement = judged(found, truth, static_cast<std::size_t>(board.object.pixels()));
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
