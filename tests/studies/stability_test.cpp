#include "studies/stability/stability.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "recon/condition_number.hpp"
#include "recon/solver_list.hpp"
#include "studies/stability/optimum_bound.hpp"
#include "studies/stability/stability_files.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::tests::Picture;

namespace {

recon::Response small_eye() {
  tests::Random random(5);
  return tests::random_response(random, 10, Picture{6, 6}, 0.5);
}

StabilityOptions options_of(std::vector<std::string> cases) {
  StabilityOptions options;
  options.cases = std::move(cases);
  options.iterations = 400;
  options.objective.constraint = recon::ConstraintKind::box;
  return options;
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("every hard case of a small eye is solved or fails safe, by every solver in both precisions") {
  const Stability found = measure_stability(small_eye(), "an eye", options_of({}), {}).value();
  REQUIRE(found.cases.size() == hard_cases().size());
  CHECK(found.planned == found.cases.size());
  int near = 0;
  for (const StableCase& one : found.cases) {
    CAPTURE(one.hard.name);
    CHECK(one.condition >= 1.0);
    CHECK(one.runs.size() == 2 * recon::solvers().size());
    for (const StableRun& run : one.runs) {
      CAPTURE(run.solver->name);
      CHECK(run.end != StableEnd::wrong);
      CHECK((run.end == StableEnd::refused) == !run.refusal.empty());
      near += run.accuracy && *run.accuracy < 1e-3;
    }
  }
  CHECK(near > 100);
  CHECK(lines_of(stability_csv(found)) == 1 + found.cases.size() * 2 * recon::solvers().size());
  const Figures report = stability_report(found);
  CHECK(lines_of(report.text()) >= found.cases.size());
  CHECK(report.text().find('{') == std::string::npos);  // every figure that a sentence names is there
  const std::string plot = stability_plot(found, "stability");
  for (const char* part : {"stability.svg.partial", "stability.png.partial", "'admm f32'", "'pdhg f64'", "$safe"}) {
    CHECK(plot.find(part) != std::string::npos);
  }
}

TEST_CASE("accuracy is against a bound that no picture undercuts, and a darker picture is less accurate") {
  const HardProblem problem = pose(hard_cases().front(), small_eye(), 3);
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  objective.lambda = 0.05 * lambda_of_zero(problem, objective.basis);
  OptimumBound bound(problem, objective);
  CHECK_FALSE(bound.bound());
  bound.prove(500);
  REQUIRE(bound.bound());
  const Stability found = measure_stability(small_eye(), "an eye", options_of({"as it is"}), {}).value();
  double best = 1.0;
  for (const StableRun& run : found.cases.front().runs) best = std::min(best, run.accuracy.value_or(1.0));
  CHECK(best < 1e-5);
  const std::vector<float> dark(36, 0.0F), truth(problem.truth.begin(), problem.truth.end());
  CHECK(bound.objective(dark) > bound.objective(truth));
  CHECK(bound.objective(truth) >= *bound.bound());
}

TEST_CASE("a case is the same bits for the same seed, and another for another") {
  const HardCase& hard = hard_cases()[1];
  CHECK(pose(hard, small_eye(), 4).y == pose(hard, small_eye(), 4).y);
  CHECK(pose(hard, small_eye(), 4).y != pose(hard, small_eye(), 5).y);
}

TEST_CASE("the condition of a response is known beyond the root of double's digits") {
  std::vector<double> values{1.0, 0.0, 0.0, 1e-12};
  const auto a = recon::Response::from_dense(2, 2, values).value();
  CHECK(recon::condition_number(a) == doctest::Approx(1e12));
  values[3] = 0.0;  // a blind row is no row
  CHECK(recon::condition_number(recon::Response::from_dense(2, 2, values).value()) == doctest::Approx(1.0));
}

TEST_CASE("a stop keeps the cases that are done") {
  int asked = 0;
  const auto stop_in_third = [&](std::string_view, double done, double) { return ++asked, done < 2.0; };
  const Stability found = measure_stability(small_eye(), "an eye", options_of({}), stop_in_third).value();
  CHECK(found.cases.size() == 2);
  CHECK(found.planned == hard_cases().size());
  test::check_error(
      measure_stability(small_eye(), "an eye", options_of({}), [](std::string_view, double, double) { return false; }),
      hal::ErrorCode::interrupted, "an eye", {});
}

TEST_CASE("what cannot be measured is refused by name") {
  test::check_error(measure_stability(small_eye(), "an eye", options_of({"darc"}), {}), hal::ErrorCode::usage,
                    "--cases", {"darc", "dark"});
  StabilityOptions options = options_of({});
  options.solvers = {"admn"};
  test::check_error(measure_stability(small_eye(), "an eye", options, {}), hal::ErrorCode::usage, "--solvers",
                    {"admn", "admm"});
  tests::Random random(6);
  const auto large = tests::random_response(random, 1500, Picture{40, 50}, 0.001);
  test::check_error(measure_stability(large, "a large eye", options_of({}), {}), hal::ErrorCode::out_of_range,
                    "a large eye", {"1500", "2000", std::to_string(most_entries_for_stability)});
}
