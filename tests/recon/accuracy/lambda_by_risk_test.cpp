#include "recon/lambda_by_risk.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "calib/nominal.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::recon;
using namespace compueye::tests;

namespace {

constexpr int side = 16;
constexpr int pixels = side * side;
constexpr std::size_t pixel_count = pixels;

/// Samples of one bright block on black, which is sparse in differences.
struct Scene {
  std::vector<double> truth = std::vector<double>(pixel_count, 0.0);
  std::vector<float> y;
};

void add_samples(const Response& a, double sigma, std::uint64_t seed, Scene& scene) {
  std::vector<double> samples(static_cast<std::size_t>(a.rows()));
  a.forward(scene.truth, samples);
  Random random(seed);
  for (const double s : samples) scene.y.push_back(static_cast<float>(s + sigma * random.normal()));
}

Scene noisy_block(const Response& a, double sigma, std::uint64_t seed) {
  Scene scene;
  for (int r = 4; r < 12; ++r) {
    for (int c = 3; c < 9; ++c) scene.truth[static_cast<std::size_t>(r * side + c)] = 0.6;
  }
  add_samples(a, sigma, seed, scene);
  return scene;
}

/// Bright on one side of a slanted edge, grey on the other.
Scene noisy_half(const Response& a, double sigma, std::uint64_t seed) {
  Scene scene;
  for (int r = 0; r < side; ++r) {
    for (int c = 0; c < side; ++c) scene.truth[static_cast<std::size_t>(r * side + c)] = 3 * r + c > 30 ? 0.8 : 0.2;
  }
  add_samples(a, sigma, seed, scene);
  return scene;
}

double error_at(const Response& a, const Scene& scene, Objective objective, const Plan& plan, double lambda) {
  objective.lambda = lambda;
  const auto solver = Reconstructor::create(a, objective, plan);
  REQUIRE(solver.has_value());
  const SolvedFrame frame = solve_frame(*solver, scene.y);
  double apart = 0.0, size = 0.0;
  for (std::size_t n = 0; n < pixel_count; ++n) {
    apart += (frame.x[n] - scene.truth[n]) * (frame.x[n] - scene.truth[n]);
    size += scene.truth[n] * scene.truth[n];
  }
  return apart / size;
}

}  // namespace

TEST_CASE("lambda by risk finds a better lambda than a start that is too small, whatever the draw") {
  Random random(2);
  const Response a = random_response(random, 400, Picture{side, side}, 0.3);
  Objective objective;
  objective.basis = BasisKind::tv;
  objective.constraint = ConstraintKind::box;
  objective.lambda = 0.1;
  Plan plan;
  plan.iterations = 200;
  for (const std::uint64_t seed : {3U, 4U, 5U}) {
    const Scene scene = noisy_block(a, 1.0, seed);
    const auto found = lambda_by_risk(a, objective, plan, {scene.y, {}, 1.0});
    REQUIRE(found.has_value());
    CHECK(found->trials.size() <= 15);
    CHECK(found->trials.front().lambda == 0.1);
    CHECK(found->lambda > 0.5);
    const double start = error_at(a, scene, objective, plan, 0.1);
    CHECK(error_at(a, scene, objective, plan, found->lambda) < 0.5 * start);
  }
}

TEST_CASE("the risk is estimated without bias") {
  // Tikhonov is linear: its risk is known exactly, and the estimates scatter about it.
  Random random(6);
  const Response a = random_response(random, 200, Picture{side, side}, 0.3);
  Objective objective;
  objective.lambda = 20.0;
  Plan plan;
  plan.solver = solver_named("tikhonov");
  plan.precision = Precision::f64;
  constexpr double sigma = 0.5;
  double estimated = 0.0, actual = 0.0;
  for (std::uint64_t seed = 10; seed < 30; ++seed) {
    const Scene scene = noisy_block(a, sigma, seed);
    const auto found = lambda_by_risk(a, objective, plan, {scene.y, {}, sigma});
    REQUIRE(found.has_value());
    estimated += found->trials.front().risk;
    const auto solver = Reconstructor::create(a, objective, plan);
    const SolvedFrame frame = solve_frame(*solver, scene.y);
    std::vector<double> apart(pixel_count), samples(200);
    for (std::size_t n = 0; n < pixel_count; ++n) apart[n] = frame.x[n] - scene.truth[n];
    a.forward(apart, samples);
    actual += std::inner_product(samples.begin(), samples.end(), samples.begin(), 0.0);
  }
  CHECK(estimated == doctest::Approx(actual).epsilon(0.1));
}

TEST_CASE("lambda by risk keeps the start without noise or without a channel that weighs") {
  Random random(7);
  const Response a = random_response(random, 12, Picture{side, side}, 0.3);
  Objective objective;
  objective.basis = BasisKind::dct;
  objective.constraint = ConstraintKind::box;
  objective.lambda = 0.05;
  const Scene scene = noisy_block(a, 0.5, 8);
  const std::vector<float> nothing(12, 0.0F);
  for (const NoisyFrame& frame : {NoisyFrame{scene.y, {}, 0.0}, NoisyFrame{scene.y, nothing, 0.5}}) {
    const auto found = lambda_by_risk(a, objective, {}, frame);
    REQUIRE(found.has_value());
    CHECK(found->lambda == 0.05);
    CHECK(found->trials.empty());
  }
}

TEST_CASE("on an eye lambda by risk stays near the best lambda at any noise, where the rule does not") {
  constexpr double deg = std::numbers::pi / 180.0;
  hal::EyeGeometry eye;
  eye.rows = eye.columns = 8;
  eye.interommatidial_rad = 1.5 * deg;
  eye.acceptance_rad = 8.0 * deg;
  const Response a = calib::nominal_response(eye, hal::ObjectPlane{side, side, 8, 8, 30}).value();
  Objective objective;
  objective.basis = BasisKind::dct;
  objective.constraint = ConstraintKind::box;
  Plan plan;
  plan.iterations = 200;
  double worst_by_rule = 0.0;
  for (const double sigma : {0.1, 1.0, 5.0, 20.0}) {
    objective.lambda = lambda_by_rule(a, plan.solver, objective.basis, sigma).value();
    for (const std::uint64_t seed : {21U, 22U}) {
      const Scene scene = noisy_half(a, sigma, seed);
      double best = 1.0;
      for (int k = -4; k <= 16; ++k) {
        best = std::min(best, error_at(a, scene, objective, plan, objective.lambda * std::exp2(k)));
      }
      CAPTURE(sigma);
      CAPTURE(seed);
      const auto found = lambda_by_risk(a, objective, plan, {scene.y, {}, sigma});
      REQUIRE(found.has_value());
      CHECK(error_at(a, scene, objective, plan, found->lambda) <= 2.5 * best);
      worst_by_rule = std::max(worst_by_rule, error_at(a, scene, objective, plan, objective.lambda) / best);
    }
  }
  CHECK(worst_by_rule > 3.0);
}

TEST_CASE("lambda by risk does not fall where iterations are too few to follow") {
  Random random(17);
  const Response a = random_response(random, 200, Picture{side, side}, 0.3);
  Objective objective;
  objective.basis = BasisKind::dct;
  objective.constraint = ConstraintKind::box;
  objective.lambda = 5.0;
  const Scene scene = noisy_half(a, 0.2, 18);
  const auto lowest = [&](int iterations, bool warm) {
    Plan plan;
    plan.solver = solver_named(warm ? "pdhg" : "admm");
    plan.iterations = iterations;
    plan.warm_start = warm;
    const auto found = lambda_by_risk(a, objective, plan, {scene.y, {}, 0.2});
    REQUIRE(found.has_value());
    double least = found->lambda;
    for (const LambdaTrial& trial : found->trials) least = std::min(least, trial.lambda);
    return least;
  };
  CHECK(lowest(100, false) < 5.0);
  CHECK(lowest(99, false) == 5.0);
  CHECK(lowest(200, true) == 5.0);
}

TEST_CASE("lambda by risk keeps the start where no picture explains the samples, and says how far off it is") {
  Random random(19);
  const Response a = random_response(random, 200, Picture{side, side}, 0.3);
  const Response another = random_response(random, 200, Picture{side, side}, 0.3);
  Objective objective;
  objective.basis = BasisKind::dct;
  objective.constraint = ConstraintKind::box;
  objective.lambda = 0.1;
  const Scene own = noisy_half(a, 0.5, 20), foreign = noisy_half(another, 0.5, 20);
  Plan plan;
  plan.iterations = 300;
  const auto explained = lambda_by_risk(a, objective, plan, {own.y, {}, 0.5});
  const auto not_explained = lambda_by_risk(a, objective, plan, {foreign.y, {}, 0.5});
  REQUIRE(explained.has_value());
  REQUIRE(not_explained.has_value());
  CHECK(explained->unexplained == 0.0);
  CHECK(not_explained->lambda == 0.1);
  CHECK(not_explained->unexplained > 2.0);
}

TEST_CASE("lambda by risk follows the unit of the samples") {
  Random random(13);
  const Response a = random_response(random, 60, Picture{side, side}, 0.3);
  Objective objective;
  objective.basis = BasisKind::dct;
  const Scene scene = noisy_block(a, 0.5, 14);
  const auto chosen = [&](float unit) {
    std::vector<float> y = scene.y;
    for (float& v : y) v *= unit;
    objective.lambda = 0.05 * double{unit};
    return lambda_by_risk(a, objective, {}, {y, {}, 0.5 * double{unit}}).value().lambda / double{unit};
  };
  for (const float unit : {0x1p-20F, 0x1p10F}) CHECK(chosen(unit) == chosen(1.0F));
}

TEST_CASE("lambda by risk looks at no channel without weight, and at nothing where there is nothing to see") {
  Random random(15);
  const Response a = random_response(random, 60, Picture{side, side}, 0.3);
  Objective objective;
  objective.basis = BasisKind::haar;
  objective.lambda = 0.05;
  Scene scene = noisy_block(a, 0.5, 16);
  std::vector<float> weights(60, 1.0F);
  weights[7] = 0.0F;
  Plan plan;
  plan.max_reweighted = 1;
  const auto masked = [&](float value) {
    scene.y[7] = value;
    return lambda_by_risk(a, objective, plan, {scene.y, weights, 0.5}).value().lambda;
  };
  CHECK(masked(std::nanf("")) == masked(3.0F));
  CHECK(masked(1e30F) == masked(3.0F));

  const std::vector<float> black(60, 0.0F);
  const auto found = lambda_by_risk(a, objective, {}, {black, {}, 0.5});
  REQUIRE(found.has_value());
  CHECK(found->lambda > 0.0);
  CHECK(std::isfinite(found->lambda));
}

TEST_CASE("lambda by risk takes a stored factor and gives the same lambda with it") {
  Random random(9);
  const Response a = random_response(random, 60, Picture{side, side}, 0.3);
  Objective objective;
  objective.basis = BasisKind::haar;
  objective.lambda = 0.01;
  const Scene scene = noisy_block(a, 0.3, 10);
  const auto solver = Reconstructor::create(a, objective, {});
  REQUIRE(solver.has_value());
  const auto with = lambda_by_risk(a, objective, {}, {scene.y, {}, 0.3}, solver->factor());
  const auto without = lambda_by_risk(a, objective, {}, {scene.y, {}, 0.3});
  REQUIRE(with.has_value());
  REQUIRE(without.has_value());
  CHECK(with->lambda == without->lambda);
  REQUIRE(with->trials.size() == without->trials.size());
  for (std::size_t k = 0; k < with->trials.size(); ++k) CHECK(with->trials[k].risk == without->trials[k].risk);
}

TEST_CASE("lambda by risk says what is wrong with its input") {
  Random random(11);
  const Response a = random_response(random, 20, Picture{side, side}, 0.3);
  Objective objective;
  objective.lambda = 0.1;
  const std::vector<float> y(20, 1.0F);
  const auto code = [&](std::span<const float> samples, double sigma, const Progress& progress = {}) {
    const auto found = lambda_by_risk(a, objective, {}, {samples, {}, sigma}, std::nullopt, progress);
    REQUIRE_FALSE(found.has_value());
    return found.error().code;
  };
  CHECK(code(std::span(y).first(19), 0.1) == hal::ErrorCode::mismatch);
  CHECK(code(y, -0.1) == hal::ErrorCode::out_of_range);
  CHECK(code(std::vector<float>(20, std::nanf("")), 0.1) == hal::ErrorCode::out_of_range);
  CHECK(code(y, 0.1, [](auto, double, double) { return false; }) == hal::ErrorCode::interrupted);
}
