// Problems at the edges of what float32 and a fixed number of iterations can do.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "recon/problem/number_text.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/relative_difference.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;
using hal::ErrorCode;
using recon::BasisKind;
using recon::ConstraintKind;
using recon::Health;
using recon::Objective;
using recon::Plan;
using recon::Precision;
using recon::Reconstructor;
using recon::Response;

namespace {

struct Frame {
  Response a;
  std::vector<double> y;
};

/// 40 channels on an 8 x 10 picture, with noise.
Frame noisy_frame() {
  Random random(51);
  Frame frame{random_response(random, 40, Picture{8, 10}, 0.3), std::vector<double>(40)};
  std::vector<double> truth(80, 0.0);
  for (double& v : truth) v = random.uniform() < 0.3 ? random.uniform(0.2, 1.0) : 0.0;
  frame.a.forward(truth, frame.y);
  for (double& v : frame.y) v += 0.02 * random.normal();
  return frame;
}

/// The same rows several times over: A A' is singular, and noisy samples of equal rows contradict each other.
Frame with_repeated_rows(const Frame& frame, int distinct) {
  std::vector<double> values;
  for (int m = 0; m < 40; ++m) {
    std::vector<double> row(80, 0.0);
    frame.a.for_each_in_row(m % distinct, [&](std::int32_t n, double v) { row[static_cast<std::size_t>(n)] = v; });
    values.insert(values.end(), row.begin(), row.end());
  }
  return {Response::from_dense(40, 80, std::move(values)).value().with_image(8, 10).value(), frame.y};
}

Response in_unit(const Response& a, double scale) {
  std::vector<std::int32_t> rows;
  for (int m = 0; m < a.rows(); ++m) rows.push_back(m);
  return a.select_rows(rows, std::vector<double>(rows.size(), scale));
}

std::vector<float> in_unit(const std::vector<double>& y, double scale) {
  std::vector<float> out;
  for (const double v : y) out.push_back(static_cast<float>(v * scale));
  return out;
}

Objective make_objective(BasisKind basis, ConstraintKind constraint, double lambda, double hi = 1.0) {
  Objective objective;
  objective.basis = basis;
  objective.constraint = constraint;
  objective.lambda = lambda;
  objective.hi = hi;
  return objective;
}

std::vector<double> to_double(const std::vector<float>& v) {
  return {v.begin(), v.end()};
}

}  // namespace

TEST_CASE("the unit of A and of x does not matter: the picture follows it") {
  const Frame frame = noisy_frame();
  std::vector<float> weights(40, 1.0F);
  weights[3] = 0.0F;
  weights[7] = 0.5F;
  for (const auto basis : {BasisKind::identity, BasisKind::dct}) {
    Plan plan;
    plan.iterations = 300;
    plan.measure_gap = true;
    const auto plain = Reconstructor::create(frame.a, make_objective(basis, ConstraintKind::box, 0.05), plan).value();
    const SolvedFrame expected = solve_frame(plain, in_unit(frame.y, 1.0), weights);
    REQUIRE(expected.info.health == Health::converged);
    for (const double unit_of_a : {1e-9, 1e-6, 1e-3, 1e4, 1e6, 1e9}) {
      for (const double unit_of_x : {1e-3, 1.0, 1e3}) {
        CAPTURE(unit_of_a);
        CAPTURE(unit_of_x);
        const Objective objective =
            make_objective(basis, ConstraintKind::box, 0.05 * unit_of_a * unit_of_a * unit_of_x, unit_of_x);
        const auto solver = Reconstructor::create(in_unit(frame.a, unit_of_a), objective, plan);
        REQUIRE(solver.has_value());
        SolvedFrame solved = solve_frame(*solver, in_unit(frame.y, unit_of_a * unit_of_x), weights);
        for (float& v : solved.x) v = static_cast<float>(static_cast<double>(v) / unit_of_x);
        CHECK(relative_difference(solved.x, expected.x) < 2e-5);
        const double unit_of_y = unit_of_a * unit_of_x;
        CHECK(solved.info.objective / (unit_of_y * unit_of_y) ==
              doctest::Approx(expected.info.objective).epsilon(1e-4));
        CHECK(solved.info.health == Health::converged);
      }
    }
  }
}

TEST_CASE("a scaling by a power of two changes no bit of the picture") {
  const Frame frame = noisy_frame();
  const auto plain =
      Reconstructor::create(frame.a, make_objective(BasisKind::dct, ConstraintKind::box, 0.05), {}).value();
  const auto larger = Reconstructor::create(in_unit(frame.a, 0x1p20),
                                            make_objective(BasisKind::dct, ConstraintKind::box, 0.05 * 0x1p40), {});
  REQUIRE(larger.has_value());
  CHECK(solve_frame(plain, in_unit(frame.y, 1.0)).x == solve_frame(*larger, in_unit(frame.y, 0x1p20)).x);
}

TEST_CASE("a response whose samples would be no float32 is refused, not shown black") {
  const Frame frame = noisy_frame();
  for (const double unit : {1e-300, 1e-38, 1e38, 1e200}) {
    CAPTURE(unit);
    const Response a = in_unit(frame.a, unit);
    const double column = std::sqrt(a.squared_norm() / a.cols());
    test::check_error(Reconstructor::create(a, Objective{}, {}), ErrorCode::out_of_range, "response",
                      {recon::number_text(column), "1e-35", "1e35"});
  }
}

TEST_CASE("converged means close to the optimum, whatever rho is") {
  const Frame noisy = noisy_frame();
  int converged = 0, refused = 0;
  for (const Frame& frame : {noisy, with_repeated_rows(noisy, 25)}) {
    const Objective objective = make_objective(BasisKind::dct, ConstraintKind::box, 0.05);
    std::vector<double> y = to_double(in_unit(frame.y, 1.0));
    const auto best = recon::reference::solve_reference(frame.a, objective, y);
    REQUIRE(best.converged);
    for (const auto precision : {Precision::f32, Precision::f64}) {
      for (const double rho : {1e-40, 1e-14, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 1e3, 1e5, 1e12, 1e40}) {
        CAPTURE(rho);
        CAPTURE(static_cast<int>(precision));
        Plan plan;
        plan.precision = precision;
        plan.rho = rho;
        plan.iterations = 2000;
        plan.measure_gap = true;
        const auto solver = Reconstructor::create(frame.a, objective, plan);
        if (!solver) {
          CHECK(solver.error().code == ErrorCode::out_of_range);
          CHECK((rho < 1e-3 || rho > 1e5));
          ++refused;
          continue;
        }
        const SolvedFrame solved = solve_frame(*solver, in_unit(frame.y, 1.0));
        CHECK(solved.info.health != Health::invalid);
        CHECK(std::all_of(solved.x.begin(), solved.x.end(), [](float v) { return v >= 0.0F && v <= 1.0F; }));
        if (solved.info.health != Health::converged) continue;
        ++converged;
        const double reached = recon::reference::objective_value(frame.a, objective, y, {}, to_double(solved.x));
        CHECK(reached <= best.objective * 1.01);
      }
    }
  }
  CHECK(converged >= 8);
  CHECK(refused >= 8);
}

TEST_CASE("a rho too small for float32 is refused where A A' is singular, and double takes over") {
  const Frame frame = with_repeated_rows(noisy_frame(), 25);
  Plan plan;
  plan.rho = 1e-6;
  test::check_error(Reconstructor::create(frame.a, Objective{}, plan), ErrorCode::out_of_range, "rho", {"1e-06"});
  plan.precision = Precision::f64;
  CHECK(Reconstructor::create(frame.a, Objective{}, plan).has_value());
  Objective objective;
  objective.lambda = 1e-6;
  Plan tikhonov;
  tikhonov.solver = recon::solver_named("tikhonov");
  CHECK_FALSE(Reconstructor::create(frame.a, objective, tikhonov).has_value());
}

TEST_CASE("one pixel and one row have their closed forms") {
  // min 1/2 (2 x - 3)^2 + |x| / 2: x = (6 - 1/2) / 4.
  const Response one = Response::from_dense(1, 1, {2.0}).value().with_image(1, 1).value();
  for (const auto basis : {BasisKind::identity, BasisKind::dct}) {
    for (const auto precision : {Precision::f32, Precision::f64}) {
      Plan plan;
      plan.precision = precision;
      plan.iterations = 500;
      const auto free = Reconstructor::create(one, make_objective(basis, ConstraintKind::none, 0.5), plan);
      REQUIRE(free.has_value());
      CHECK(solve_frame(*free, {3.0F}).x[0] == doctest::Approx(1.375).epsilon(1e-5));
      const auto box = Reconstructor::create(one, make_objective(basis, ConstraintKind::box, 0.5), plan);
      REQUIRE(box.has_value());
      CHECK(solve_frame(*box, {3.0F}).x[0] == 1.0F);
      CHECK(solve_frame(*box, {-3.0F}).x[0] == 0.0F);
      CHECK(solve_frame(*box, {3.0F}, {0.0F}).x[0] == 0.0F);
      CHECK(solve_frame(*free, {3.0F}, {0.5F}).x[0] == doctest::Approx((3.0 - 0.5) / 2.0).epsilon(1e-5));
    }
  }
  // One row: min-norm direction a / ||a||^2, shrunk by rho = lambda.
  const Response row = Response::from_dense(1, 6, {0.0, 1.0, 2.0, 0.0, -1.0, 0.5}).value().with_image(2, 3).value();
  Objective objective;
  objective.lambda = 0.25;
  Plan tikhonov;
  tikhonov.solver = recon::solver_named("tikhonov");
  const auto solver = Reconstructor::create(row, objective, tikhonov).value();
  const SolvedFrame frame = solve_frame(solver, {13.0F});
  for (std::size_t n = 0; n < 6; ++n) {
    const double expected = 13.0 * row.values()[n] / (6.25 + 0.25);
    CHECK(static_cast<double>(frame.x[n]) == doctest::Approx(expected).epsilon(1e-5));
  }
}

TEST_CASE("pictures of every awkward size reach the reference") {
  Random random(52);
  for (const auto& [height, width] : {std::pair{1, 17}, {17, 1}, {3, 11}, {1, 2}, {15, 3}, {5, 7}}) {
    const int rows = height, cols = width;  // clang 14 captures no structured binding
    for (const auto constraint : {ConstraintKind::none, ConstraintKind::box}) {
      CAPTURE(rows);
      CAPTURE(cols);
      const int n = rows * cols, m = (n + 1) / 2;
      const Response a = random_response(random, m, Picture{rows, cols}, 0.8);
      const auto y = to_float(random_vector(random, m, 0.0, 2.0));
      const Objective objective = make_objective(BasisKind::dct, constraint, 0.1);
      const auto best = recon::reference::solve_reference(a, objective, to_double(y));
      REQUIRE(best.converged);
      Plan plan;
      plan.iterations = 5000;
      const SolvedFrame frame = solve_frame(Reconstructor::create(a, objective, plan).value(), y);
      const double reached = recon::reference::objective_value(a, objective, to_double(y), {}, to_double(frame.x));
      CHECK(reached <= best.objective * (1.0 + 1e-4) + 1e-7);
    }
  }
}

TEST_CASE("weights of one cost nothing and change nothing, also where none may differ from one") {
  const Frame frame = noisy_frame();
  Plan plan;
  plan.max_reweighted = 0;
  const auto solver =
      Reconstructor::create(frame.a, make_objective(BasisKind::dct, ConstraintKind::box, 0.05), plan).value();
  const auto y = in_unit(frame.y, 1.0);
  const SolvedFrame bare = solve_frame(solver, y), with_ones = solve_frame(solver, y, std::vector<float>(40, 1.0F));
  CHECK(bare.x == with_ones.x);
  CHECK(bare.info.channels_reweighted == 0);
  std::vector<float> one_missing(40, 1.0F);
  one_missing[0] = 0.0F;
  CHECK(solve_frame(solver, y, one_missing).info.health == Health::invalid);
}

TEST_CASE("weights next to nought and next to one are as good as nought and one") {
  const Frame frame = noisy_frame();
  Plan plan;
  plan.iterations = 300;
  plan.max_reweighted = 40;
  const auto solver =
      Reconstructor::create(frame.a, make_objective(BasisKind::dct, ConstraintKind::box, 0.05), plan).value();
  const auto y = in_unit(frame.y, 1.0);
  const auto with = [&](float w) {
    std::vector<float> weights(40, 1.0F);
    for (std::size_t m = 0; m < 40; m += 4) weights[m] = w;
    return solve_frame(solver, y, weights);
  };
  const SolvedFrame missing = with(0.0F), whole = with(1.0F);
  for (const float w : {1e-45F, 1e-38F, 1e-20F, 1e-7F}) {
    CHECK(relative_difference(with(w).x, missing.x) < 1e-4);
    CHECK(with(w).info.channels_used == 40);
  }
  CHECK(relative_difference(with(std::nextafter(1.0F, 0.0F)).x, whole.x) < 1e-4);
  CHECK(relative_difference(missing.x, whole.x) > 1e-2);
}

TEST_CASE("entries that only double can tell from nought do not reach the frame path") {
  Random random(53);
  std::vector<double> values = random_vector(random, 20 * 48, 0.0, 1.0), clean = values;
  for (std::size_t k = 0; k < values.size(); k += 3) {
    values[k] = k % 2 == 0 ? 1e-40 : -1e-300;
    clean[k] = 0.0;
  }
  const auto y = to_float(random_vector(random, 20, 0.0, 5.0));
  Plan plan;
  plan.rho = 0.5;
  const Objective objective = make_objective(BasisKind::dct, ConstraintKind::nonnegative, 0.1);
  const auto odd =
      Reconstructor::create(Response::from_dense(20, 48, values).value().with_image(6, 8).value(), objective, plan)
          .value();
  const auto plain =
      Reconstructor::create(Response::from_dense(20, 48, clean).value().with_image(6, 8).value(), objective, plan)
          .value();
  CHECK(solve_frame(odd, y).x == solve_frame(plain, y).x);
}

TEST_CASE("a frame that overflows is invalid, black and without figures") {
  const Frame frame = noisy_frame();
  for (const auto precision : {Precision::f32, Precision::f64}) {
    Plan plan;
    plan.precision = precision;
    // A picture 1e6 times as large as the samples.
    const auto solver = Reconstructor::create(in_unit(frame.a, 1e-6),
                                              make_objective(BasisKind::identity, ConstraintKind::none, 0.0), plan);
    REQUIRE(solver.has_value());
    const SolvedFrame solved = solve_frame(*solver, std::vector<float>(40, 3e38F));
    CHECK(solved.info.health == Health::invalid);
    CHECK(solved.info.objective == 0.0);
    CHECK(solved.info.residual == 0.0);
    CHECK(solved.info.primal_residual == 0.0);
    for (const float v : solved.x) CHECK(v == 0.0F);
  }
}
