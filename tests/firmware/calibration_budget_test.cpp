// What errors of the rows do to pictures: against pictures of rows that are off.

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calib/nominal.hpp"
#include "firmware/calibration/error_budget.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/metrics.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/random/random.hpp"
#include "tests/source_folder.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

const std::vector<double> frames(100, 2.0);
constexpr double gain_error = 2e-3;  // about what noise does

/// The nominal rows, said to be off by their gains alone, and to be off by half of that with twice the patterns.
calib::ResponseEstimate with_gain_errors(const Board& board) {
  const recon::Response nominal = calib::nominal_response(board.eye, board.object).value();
  calib::ResponseEstimate estimate;
  for (int m = 0; m < nominal.rows(); ++m) {
    calib::RowEstimate& row = estimate.rows.emplace_back();
    nominal.for_each_in_row(m, [&](std::int32_t n, double v) {
      row.columns.push_back(n);
      row.values.push_back(static_cast<float>(v));
      row.sigmas.push_back(static_cast<float>(3.0 * gain_error * v));
    });
    row.inflation = 3.0;
    row.held_out_chi2 = m % 2 == 0 ? 1.0 : 4001.0;
    row.errors.emplace();
    row.errors->now[0] = gain_error;
    row.errors->of_twice[0] = 0.5 * gain_error;
  }
  return estimate;
}

/// NMSE of fig2 by the nominal rows, its samples without noise; gains off by so much, mean over drawings.
double nmse_with(const Board& board, double error) {
  const recon::Response nominal = calib::nominal_response(board.eye, board.object).value();
  const ReadyEye eye =
      ReadyEye::make(board, living_response(board, nominal), "", [](auto, double, double) { return true; }).value();
  const hal::Image truth = sim::render_built_in("fig2", board.object.rows, board.object.cols, 0).value();
  std::vector<double> light(static_cast<std::size_t>(nominal.rows()));
  nominal.forward(std::vector<double>(truth.pixels.begin(), truth.pixels.end()), light);
  const recon::AlignedWorkspace workspace(eye.reconstructor().required_bytes());
  sim::RandomStream random({7, sim::Draws::picture, 1, 2});
  double sum = 0.0;
  constexpr int drawings = 8;
  for (int d = 0; d < drawings; ++d) {
    std::vector<float> y;
    for (const double each : light) y.push_back(static_cast<float>(each * (1.0 + error * random.gaussian())));
    hal::Image found(truth.rows, truth.cols);
    eye.reconstructor().forget_last_frame(workspace.span());
    static_cast<void>(eye.reconstructor().solve(y, {}, workspace.span(), found.pixels));
    sum += recon::nmse(found, truth).value();
  }
  return sum / drawings;
}

}  // namespace

TEST_CASE("a budget says what pictures by rows with such gains come to, and what twice the patterns take off") {
  const Board board = load_board(test::source_path("boards/sim-8x8")).value();
  const ErrorBudget budget =
      error_budget(board, with_gain_errors(board), frames, [](auto, double, double) { return true; }).value();
  const double without = nmse_with(board, 0.0), added = nmse_with(board, gain_error) - without;
  CHECK(budget.unperturbed == doctest::Approx(without).epsilon(1e-3));
  CHECK(budget.rows() > 0.5 * added);
  CHECK(budget.rows() < 2.0 * added);
  CHECK(budget.rows_with_twice() == doctest::Approx(0.25 * budget.rows()));
  // Half of the rows leave four thousand times the noise of two frames.
  CHECK(budget.misfit() == doctest::Approx(1000.0 * budget.noise - budget.rows()));
  CHECK(budget.patterns == 100);
  CHECK(budget.misfit_share == 1.0);
  CHECK(budget.largest() == "misfit");
  CHECK(budget.largest_kind() == 0);
  CHECK(budget.noise > 0.0);
}

TEST_CASE("a budget comes back from an estimate's figures, whole or not at all") {
  ErrorBudget budget;
  double next = 0.5;
  for (ErrorBudget::Kind& kind : budget.kinds) kind = {next += 1.0, next += 1.0, next += 1.0};
  budget.noise = 1e-3;
  budget.unperturbed = 2e-3;
  budget.surplus = 3.5;
  budget.misfit_share = 0.125;
  budget.patterns = 256;
  std::vector<calib::NamedNumber> numbers = numbers_of(budget);
  const ErrorBudget back = budget_from(numbers).value();
  CHECK(json_text(figures_of(back)) == json_text(figures_of(budget)));
  CHECK(back.kinds[2].of_twice == budget.kinds[2].of_twice);
  numbers.front().value = std::nan("");
  CHECK_FALSE(budget_from(numbers).has_value());
  CHECK_FALSE(budget_from({{"pose", 170.0}}).has_value());
}

TEST_CASE("rows that do not tell their errors by kind have no budget") {
  const Board board = load_board(test::source_path("boards/sim-8x8")).value();
  calib::ResponseEstimate rows = with_gain_errors(board);
  for (calib::RowEstimate& row : rows.rows) row.errors.reset();
  const auto budget = error_budget(board, rows, frames, {});
  REQUIRE_FALSE(budget.has_value());
  CHECK(budget.error().code == hal::ErrorCode::usage);
}
