#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

#include "calib/nominal.hpp"
#include "recon/setup/dual_step_tables.hpp"
#include "recon/setup/leading_modes.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/dense_matrix.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/reference/reference_solver.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

/// 20 x 20 ommatidia of 40 degrees: a few modes far above the rest, as on a large eye.
recon::Response wide_eye() {
  constexpr double deg = std::numbers::pi / 180.0;
  hal::EyeGeometry eye;
  eye.rows = eye.columns = 20;
  eye.interommatidial_rad = 3.0 * deg;
  eye.acceptance_rad = 40.0 * deg;
  return calib::nominal_response(eye, {32, 32, 30.0, 30.0, 20.0}).value();
}

/// The same rows turned so that no symmetry is left.
recon::Response without_symmetry(const recon::Response& a) {
  std::vector<double> values(static_cast<std::size_t>(a.rows()) * static_cast<std::size_t>(a.cols()), 0.0);
  for (int m = 0; m < a.rows(); ++m) {
    double* row = values.data() + static_cast<std::size_t>(m) * static_cast<std::size_t>(a.cols());
    a.for_each_in_row(m, [&](std::int32_t n, double v) { row[n] = v * (1.0 + 0.01 * (m % 7)); });
  }
  return recon::Response::from_dense(a.rows(), a.cols(), values)
      .value()
      .with_image(a.image_rows(), a.image_cols())
      .value();
}

struct Frame {
  std::vector<float> y;
  recon::Objective objective;
};

Frame noisy_blocks(const recon::Response& a) {
  Random random(5);
  std::vector<double> truth(static_cast<std::size_t>(a.cols()), 0.1), y(static_cast<std::size_t>(a.rows()));
  for (std::size_t k = 0; k < truth.size(); ++k) truth[k] += (k / 8 % 4 == 1 && k / 256 % 2 == 0) ? 0.7 : 0.0;
  a.forward(truth, y);
  Frame frame;
  for (const double v : y) frame.y.push_back(static_cast<float>(v + 0.1 * random.normal()));
  frame.objective.basis = recon::BasisKind::dct;
  frame.objective.constraint = recon::ConstraintKind::box;
  frame.objective.lambda = 0.1;
  return frame;
}

recon::Plan plan_of(recon::SolverKind solver, int iterations, recon::Precision precision = recon::Precision::f32) {
  recon::Plan plan;
  plan.solver = solver;
  plan.iterations = iterations;
  plan.precision = precision;
  return plan;
}

recon::FrameInfo solved(const recon::Response& a, const Frame& frame, const recon::Plan& plan,
                        const std::vector<float>& weights = {}) {
  const auto solver = recon::Reconstructor::create(a, frame.objective, plan);
  REQUIRE(solver.has_value());
  return solve_frame(*solver, frame.y, weights).info;
}

}  // namespace

namespace {

/// F v, as much shorter as it is stored, from F's definition: eigenvectors of A A' are F's, so F (A A' v) is a function
/// of the modes alone.
std::vector<double> deflated_by_definition(const recon::ParityClasses& classes, const std::vector<float>& modes,
                                           int rank, double step, double share, const std::vector<float>& v,
                                           const recon::core::DeflatedStep<float>& stored, std::size_t level) {
  std::vector<double> expected(v.size(), 0.0);
  const float* values = modes.data();
  for (std::size_t c = 0; c < classes.count(); ++c) {
    const std::size_t count = recon::modes_of_class(classes, c, rank),
                      size = static_cast<std::size_t>(classes.order(c));
    const auto gain = [&](std::size_t k) {
      return 1.0 / (1.0 + step * static_cast<double>(values[k]) / (1.0 - share));
    };
    std::vector<double> in(size, 0.0), moved(size, 0.0);
    for (std::size_t m = 0; m < v.size(); ++m) {
      const int p = classes.index(c, static_cast<int>(m));
      if (p >= 0) in[static_cast<std::size_t>(p)] += classes.share(c, static_cast<int>(m)) * static_cast<double>(v[m]);
    }
    const float* vectors = values + count + 1;
    const double shorter = static_cast<double>(stored.parts[c].rest[level]) / gain(count);
    CHECK(shorter <= 1.0);
    CHECK(shorter > 0.88);  // by what rounding may have added
    for (std::size_t p = 0; p < size; ++p) in[p] *= shorter, moved[p] = gain(count) * in[p];
    for (std::size_t k = 0; k < count; ++k) {
      double along = 0.0;
      for (std::size_t p = 0; p < size; ++p) along += static_cast<double>(vectors[p * count + k]) * in[p];
      for (std::size_t p = 0; p < size; ++p) {
        moved[p] += (gain(k) - gain(count)) * along * static_cast<double>(vectors[p * count + k]);
      }
    }
    for (std::size_t m = 0; m < v.size(); ++m) {
      const int p = classes.index(c, static_cast<int>(m));
      if (p >= 0) expected[m] += classes.share(c, static_cast<int>(m)) * moved[static_cast<std::size_t>(p)];
    }
    values += count + 1 + count * size;
  }
  return expected;
}

/// Of two vectors, relative to a third.
double distance(const std::vector<float>& a, const std::vector<double>& b, const std::vector<float>& unit) {
  double error = 0.0, size = 0.0;
  for (std::size_t m = 0; m < a.size(); ++m) {
    error += std::pow(static_cast<double>(a[m]) - b[m], 2);
    size += std::pow(static_cast<double>(unit[m]), 2);
  }
  return std::sqrt(error / size);
}

}  // namespace

TEST_CASE("the deflated step is the matrix it stands for at every level, by parity classes and whole") {
  const recon::Response symmetric = wide_eye();
  for (const recon::Response& eye : {symmetric, without_symmetry(symmetric)}) {
    const recon::Response a = eye.select_rows(eye.seeing_rows());
    const recon::ParityClasses classes(a.rows(), recon::find_mirror_symmetry(a));
    const int rank = 96;
    const double share = 0.25;
    const std::vector<double> penalties{20.0, 3.0, 70.0};
    const auto modes = recon::leading_modes(a, rank, {}).value();
    REQUIRE(modes.size() == recon::modes_size(classes, rank));
    const auto tables = recon::dual_step_tables<float>(classes, modes, rank, penalties, share).value();
    REQUIRE(tables.view.levels == penalties.size());
    const auto order = static_cast<std::size_t>(a.rows());
    Random random(8);
    std::vector<float> v(order), out(order), scratch(tables.view.scratch_size());
    for (float& value : v) value = static_cast<float>(random.normal());
    for (std::size_t level = 0; level < penalties.size(); ++level) {
      recon::core::apply(tables.view, level, v.data(), out.data(), scratch.data());
      const auto expected =
          deflated_by_definition(classes, modes, rank, 1.0 / penalties[level], share, v, tables.view, level);
      // Each of the modes passes with an error of 2^-9 of itself, in directions that have nothing to do with each
      // other.
      CHECK(distance(out, expected, v) <= 1.0 / 512.0);
    }
    const std::vector<std::size_t> index{0, 7, 31, order - 1};
    std::vector<double> part(16);
    recon::core::restrict_to(tables.view, index.data(), 4, part.data(), scratch.data());
    for (std::size_t s = 0; s < 4; ++s) {
      std::vector<float> unit(order, 0.0F), column(order);
      unit[index[s]] = 1.0F;
      recon::core::apply(tables.view, 0, unit.data(), column.data(), scratch.data());
      for (std::size_t r = s; r < 4; ++r) {
        CHECK(part[r * 4 + s] == doctest::Approx(static_cast<double>(column[index[r]])).epsilon(1e-4));
      }
    }
  }
}

namespace {

/// Dense rows of positive numbers: one mode far above many that are all alike, the hardest for rounded ones.
recon::Response positive_rows(int rows, int image_rows, int image_cols, double floor = 0.0) {
  Random random(11);
  const int pixels = image_rows * image_cols;
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < rows; ++m) {
    for (int n = 0; n < pixels; ++n) {
      columns.push_back(n);
      values.push_back(floor + random.uniform());
    }
    start.push_back(static_cast<std::int64_t>(values.size()));
  }
  return recon::Response::from_csr(rows, pixels, start, columns, values)
      .value()
      .with_image(image_rows, image_cols)
      .value();
}

/// The stored F and (I + A A' / (penalty (1 - share)))^(-1), which it may nowhere exceed.
struct DenseSteps {
  Eigen::MatrixXd stored, bound;
};

DenseSteps dense_steps(const recon::Response& a, int rank, double penalty, double share) {
  const recon::ParityClasses classes(a.rows(), recon::find_mirror_symmetry(a));
  const auto modes = recon::leading_modes(a, rank, {}).value();
  const auto tables = recon::dual_step_tables<double>(classes, modes, rank, {penalty}, share).value();
  const auto order = static_cast<Eigen::Index>(a.rows());
  DenseSteps steps{Eigen::MatrixXd(order, order), Eigen::MatrixXd::Identity(order, order)};
  std::vector<double> scratch(tables.view.scratch_size());
  for (Eigen::Index k = 0; k < order; ++k) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(order, k);
    recon::core::apply(tables.view, 0, unit.data(), steps.stored.col(k).data(), scratch.data());
  }
  const Eigen::MatrixXd dense = dense_matrix(a);
  steps.bound += dense * dense.transpose() / (penalty * (1.0 - share));
  steps.bound = steps.bound.inverse().eval();
  return steps;
}

}  // namespace

TEST_CASE("the metric of the modes as they are stored keeps to the bound on the steps, whatever the response") {
  const recon::Response eye = wide_eye();
  struct Case {
    recon::Response a;
    int rank;
    double penalty;
  };
  for (const Case& each : {Case{positive_rows(64, 16, 16), 64, 1.3}, Case{positive_rows(64, 16, 16), 20, 1.3},
                           Case{positive_rows(84, 16, 16), 84, 0.02}, Case{eye.select_rows(eye.seeing_rows()), 96, 3.0},
                           Case{without_symmetry(eye.select_rows(eye.seeing_rows())), 96, 3.0}}) {
    CAPTURE(each.rank);
    CAPTURE(each.penalty);
    const DenseSteps steps = dense_steps(each.a, each.rank, each.penalty, 0.18);
    const Eigen::MatrixXd symmetric = 0.5 * (steps.stored + steps.stored.transpose());
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> relative(symmetric, steps.bound,
                                                                             Eigen::EigenvaluesOnly);
    CHECK(relative.eigenvalues().maxCoeff() <= 1.0 + 1e-3);
    CHECK(relative.eigenvalues().minCoeff() > 0.0);
  }
}

TEST_CASE("pdhg finds the optimum of dense positive rows at its default settings") {
  const recon::Response a = positive_rows(48, 12, 12);
  Random random(12);
  Frame frame;
  std::vector<double> truth(static_cast<std::size_t>(a.cols()), 0.0), y(static_cast<std::size_t>(a.rows()));
  for (double& value : truth) value = random.uniform() < 0.1 ? random.uniform() : 0.0;
  a.forward(truth, y);
  for (double& value : y) frame.y.push_back(static_cast<float>(value + 0.01 * random.normal()));
  std::vector<double> samples(frame.y.begin(), frame.y.end());
  for (const recon::BasisKind basis : {recon::BasisKind::identity, recon::BasisKind::dct}) {
    for (const recon::ConstraintKind constraint :
         {recon::ConstraintKind::none, recon::ConstraintKind::nonnegative, recon::ConstraintKind::box}) {
      frame.objective = {};
      frame.objective.basis = basis;
      frame.objective.constraint = constraint;
      frame.objective.lambda = basis == recon::BasisKind::identity ? 0.05 : 0.5;
      const auto best = recon::reference::solve_reference(a, frame.objective, samples);
      REQUIRE(best.converged);
      const double found = solved(a, frame, plan_of(recon::solver_named("pdhg"), 3000)).objective;
      CAPTURE(static_cast<int>(basis));
      CAPTURE(static_cast<int>(constraint));
      CHECK(found == doctest::Approx(best.objective).epsilon(0.003));
    }
  }
}

TEST_CASE("pdhg refuses steps that are longer than its modes are exact, and says how long they may be") {
  const recon::Response a = positive_rows(64, 16, 16, 1e4);
  Frame frame;
  frame.objective.lambda = 0.1;
  recon::Plan plan = plan_of(recon::solver_named("pdhg"), 10);
  CHECK(recon::Reconstructor::create(a, frame.objective, plan).has_value());
  plan.rho = 1.0;
  test::check_error(recon::Reconstructor::create(a, frame.objective, plan), hal::ErrorCode::out_of_range, "rho", {});
}

TEST_CASE("a few modes make pdhg converge in tens of iterations, with and without symmetry") {
  const recon::Response symmetric = wide_eye();
  for (const recon::Response& a : {symmetric, without_symmetry(symmetric)}) {
    const Frame frame = noisy_blocks(a);
    const auto best = solved(a, frame, plan_of(recon::solver_named("admm"), 20'000, recon::Precision::f64)).objective;
    recon::Plan plan = plan_of(recon::solver_named("pdhg"), 200);
    plan.rank = 96;
    const double with_modes = solved(a, frame, plan).objective / best - 1.0;
    plan.rank = 1;
    const double with_one = solved(a, frame, plan).objective / best - 1.0;
    CHECK(with_modes < 0.01);
    CHECK(with_modes > -1e-4);
    CHECK(with_one > 3.0 * with_modes);
  }
}

TEST_CASE("missing channels do not spoil the metric") {
  const recon::Response a = wide_eye();
  const Frame frame = noisy_blocks(a);
  std::vector<float> weights(frame.y.size(), 1.0F);
  for (std::size_t m = 3; m < weights.size(); m += 20) weights[m] = m % 40 == 3 ? 0.0F : 0.3F;  // 5 %
  recon::Plan plan = plan_of(recon::solver_named("pdhg"), 100);
  plan.rank = 96;
  const auto excess = [&](const std::vector<float>& w) {
    const double best =
        solved(a, frame, plan_of(recon::solver_named("admm"), 20'000, recon::Precision::f64), w).objective;
    return solved(a, frame, plan, w).objective / best - 1.0;
  };
  const double all = excess({}), some = excess(weights);
  MESSAGE("excess of the objective: ", all, " with all channels, ", some, " with 5 % missing or weak");
  CHECK(some < 2.0 * all + 1e-3);
}

TEST_CASE("stored modes give the same frames, and only those of the same rank") {
  const recon::Response a = wide_eye();
  const Frame frame = noisy_blocks(a);
  recon::Plan plan = plan_of(recon::solver_named("pdhg"), 10);
  plan.rank = 64;
  const auto first = recon::Reconstructor::create(a, frame.objective, plan).value();
  const recon::Factor wanted = recon::Reconstructor::wanted_factor(a, frame.objective, plan);
  CHECK(first.factor().rank == 64);
  CHECK(wanted.rank == 64);
  CHECK(wanted.order == first.factor().order);
  CHECK(wanted.rho == first.factor().rho);
  const auto again = recon::Reconstructor::create(a, frame.objective, plan, first.factor()).value();
  CHECK(solve_frame(first, frame.y).x == solve_frame(again, frame.y).x);
  // One set of modes serves every basis and every step.
  recon::Objective tv = frame.objective;
  tv.basis = recon::BasisKind::tv;
  plan.rho = 3.0;
  CHECK(recon::Reconstructor::create(a, tv, plan, first.factor()).has_value());
  plan.rank = 48;
  CHECK(recon::Reconstructor::create(a, frame.objective, plan, first.factor()).error().code == hal::ErrorCode::stale);
}
