// Rows between two distances that were measured, against those that the simulated eye has there.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/depth/between_distances.hpp"
#include "firmware/calibration/calibration_run.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/calibration/simulated_bench.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/eye/stored_rows.hpp"
#include "tests/firmware/short_session.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/firmware/true_rows.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::firmware;
using test::judged;

namespace {

Board at(Board board, double distance_mm) {
  board.object.distance_mm = distance_mm;
  return board;
}

calib::ResponseEstimate calibrated(const Board& board, calib::EyeFile& file, std::uint64_t seed) {
  CalibrationRequest request = test::short_session(test::sanitized ? 12 : 24);
  request.distance_mm = board.object.distance_mm;
  request.plan.dark_frames = request.plan.black_frames = request.plan.flat_frames = test::sanitized ? 4 : 16;
  request.plan.ramp_steps = 3;
  request.plan.ramp_frames = 8;
  SimulatedBench bench = SimulatedBench::create(board, test::real_display(board), seed).value();
  const auto id = run_calibration(request, {*bench.eye, *bench.display, *bench.clock}, file,
                                  [](const calib::SessionProgress&) { return true; });
  REQUIRE_MESSAGE(id.has_value(), id.error().text());
  auto made = estimate_session(file, file.sessions().value().back(),
                               {1.0 / board.source.frame_rate_hz, 1.0 / board.sensor.lsb(), "test", 0, 1});
  REQUIRE_MESSAGE(made.has_value(), made.error().text());
  return std::move(made->rows);
}

/// What no model knows of: the middle of the entries.
calib::ResponseEstimate entries_mixed(const calib::ResponseEstimate& near, const calib::ResponseEstimate& far,
                                      int pixels) {
  calib::ResponseEstimate found = near;
  for (std::size_t m = 0; m < near.rows.size(); ++m) {
    std::vector<double> sum(static_cast<std::size_t>(pixels), 0.0);
    for (const calib::RowEstimate* row : {&near.rows[m], &far.rows[m]}) {
      for (std::size_t k = 0; k < row->columns.size(); ++k) {
        sum[static_cast<std::size_t>(row->columns[k])] += 0.5 * static_cast<double>(row->values[k]);
      }
    }
    calib::RowEstimate row;
    row.status = near.rows[m].status == hal::ChannelStatus::good ? far.rows[m].status : near.rows[m].status;
    for (std::size_t n = 0; n < sum.size(); ++n) {
      row.columns.push_back(static_cast<std::int32_t>(n));
      row.values.push_back(static_cast<float>(sum[n]));
      row.sigmas.push_back(1.0F);
    }
    found.rows[m] = std::move(row);
  }
  return found;
}

/// The rows that a session found, as a file gives them back.
calib::ResponseEstimate kept(const calib::EyeFile& file, std::int64_t estimate) {
  auto rows = rows_of(file.load_estimate(estimate).value(), file.load_response(estimate).value());
  REQUIRE(rows.has_value());
  return std::move(*rows);
}

/// A small eye of those faults; farther away more of white is seen.
Board small_built_board() {
  Board board = test::built_board();
  board.sensor.full_scale = 96.0;
  board.eye.rows = board.eye.columns = test::sanitized ? 3 : 6;
  board.object.rows = board.object.cols = test::sanitized ? 8 : 12;
  return board;
}

void check_fields(const calib::ResponseEstimate& found, const calib::ResponseEstimate& kept_rows) {
  REQUIRE(found.rows.size() == kept_rows.rows.size());
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    if (found.rows[m].status != hal::ChannelStatus::good) continue;
    CHECK(found.rows[m].parameters.field == kept_rows.rows[m].parameters.field);
    CHECK(found.rows[m].values == kept_rows.rows[m].values);
    CHECK(found.rows[m].parameters.cone.gain == kept_rows.rows[m].parameters.cone.gain);
  }
}

}  // namespace

TEST_CASE("rows between two sessions are as good as those of a session there") {
  const Board board = small_built_board();
  const int pixels = board.object.pixels();
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "a.eye").string();
  auto file = calib::EyeFile::create(path, {board.source.serial, board.eye, board.object}).value();
  const auto near = calibrated(at(board, 28.0), file, 1), far = calibrated(at(board, 32.0), file, 2);
  check_fields(near, kept(file, 1));
  const hal::ObjectPlane plane = at(board, 30.0).object;
  const auto between = calib::between_distances(board.eye, plane, {28.0, kept(file, 1)}, {32.0, kept(file, 2)}).value();

  REQUIRE(file.close().has_value());
  const MeasuredRows ready = newest_rows(path, 30.0).value();
  CHECK(std::ranges::equal(ready.response.values(), between.response(plane).value().values()));
  REQUIRE(ready.eye.between.has_value());
  CHECK(ready.eye.between->near.estimate == 1);
  CHECK(ready.eye.between->far.sessions == std::vector<std::int64_t>{2});
  CHECK(ready.eye.distance_mm == 30.0);
  CHECK(ready.eye.row_sigma > 0.0);
  CHECK_FALSE(newest_rows(path, 32.0).value().eye.between.has_value());
  for (const double beyond : {27.0, 33.0}) {
    const auto refused = newest_rows(path, beyond);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().code == hal::ErrorCode::mismatch);
    CHECK(refused.error().text().find("rows between 28 and 32 mm") != std::string::npos);
  }
  if (test::sanitized) return;

  auto other =
      calib::EyeFile::create((folder.path() / "b.eye").string(), {board.source.serial, board.eye, board.object})
          .value();
  const auto itself = calibrated(at(board, 30.0), other, 3);
  const std::vector<double> truth = test::true_rows(at(board, 30.0));
  const auto error = [&](const calib::ResponseEstimate& rows) {
    return judged(rows, truth, static_cast<std::size_t>(pixels)).error;
  };
  const auto judgement = judged(between, truth, static_cast<std::size_t>(pixels));
  MESSAGE("there " << error(itself) << ", between " << judgement.error << " (within " << judgement.within_one << " and "
                   << judgement.within_two << "), 28 mm as it is " << error(near) << ", entries "
                   << error(entries_mixed(near, far, pixels)));
  CHECK(judgement.rows >= 34);
  CHECK(judgement.error <= 1.15 * error(itself));
  CHECK(judgement.error <= 0.6 * error(entries_mixed(near, far, pixels)));
  CHECK(judgement.error <= 0.15 * error(near));
  CHECK(judgement.within_one >= 0.62);
  CHECK(judgement.within_one <= 0.85);
  CHECK(judgement.within_two >= 0.9);
}

namespace {

/// An ommatidium that looks straight ahead at 16 x 16 pixels, of the drawing's cone and of nothing else.
calib::ResponseEstimate drawn_rows(const Board& board, double gain) {
  calib::ResponseEstimate rows;
  calib::RowEstimate row;
  row.parameters.cone = calib::SoftCone(board.eye, board.object).drawn();
  row.parameters.cone.gain = gain;
  row.columns = {0};
  row.values = {1.0F};
  row.sigmas = {0.25F};
  rows.rows.assign(static_cast<std::size_t>(board.eye.ommatidia()), row);
  rows.dark_lsb.assign(rows.rows.size(), 10.0 * gain);
  return rows;
}

}  // namespace

TEST_CASE("what is not good in one of two is not good between them, and exposures are made one") {
  const Board board = at(test::quiet_board(), 29.0);
  calib::ResponseEstimate near = drawn_rows(board, 1.0), far = drawn_rows(board, 1.0);
  near.rows[3].status = hal::ChannelStatus::hot;
  far.rows[5].status = hal::ChannelStatus::dead;
  const auto found = calib::between_distances(board.eye, board.object, {28.0, near}, {32.0, far}).value();
  CHECK(found.rows[3].status == hal::ChannelStatus::hot);
  CHECK(found.rows[5].status == hal::ChannelStatus::dead);
  CHECK(found.rows[5].columns.empty());
  REQUIRE(found.rows[27].status == hal::ChannelStatus::good);
  REQUIRE_FALSE(found.rows[27].values.empty());

  // Twice the exposure gives twice the light of the same rows.
  const auto longer = drawn_rows(board, 2.0);
  const auto same =
      calib::between_distances(board.eye, board.object, {28.0, near, 0.001}, {32.0, longer, 0.002}).value();
  REQUIRE(same.rows[27].columns == found.rows[27].columns);
  for (std::size_t k = 0; k < found.rows[27].values.size(); ++k) {
    CHECK(same.rows[27].values[k] == doctest::Approx(found.rows[27].values[k]).epsilon(1e-6));
  }
  CHECK(same.dark_lsb[27] == 10.0);  // the nearer one's

  // By any number of threads, as long as they are wanted.
  const auto three = calib::between_distances(board.eye, board.object, {28.0, near}, {32.0, far}, 3).value();
  for (std::size_t m = 0; m < found.rows.size(); ++m) {
    CHECK(three.rows[m].values == found.rows[m].values);
    CHECK(three.rows[m].sigmas == found.rows[m].sigmas);
  }
  const auto stop = [](std::string_view, double done, double) { return done < 2.0; };
  const auto stopped = calib::between_distances(board.eye, board.object, {28.0, near}, {32.0, far}, 2, stop);
  REQUIRE_FALSE(stopped.has_value());
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
  CHECK(found.dark_lsb[27] == 10.0);
}
