// How much errors of samples spoil a picture, against what linear algebra says of a linear solver.

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>

#include "recon/aligned_workspace.hpp"
#include "recon/sensitivity.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::Reconstructor;
using recon::Response;

namespace {

constexpr double damping = 0.3;

struct Linear {
  Random random{161};
  Response a = random_response(random, 20, Picture{6, 5}, 0.7);
  hal::Image truth{6, 5};
  recon::Objective objective;
  recon::Plan plan;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(20, 30);
  Eigen::VectorXd picture = Eigen::VectorXd::Zero(30);

  Linear() {
    for (int n = 0; n < 30; ++n) {
      truth.pixels[static_cast<std::size_t>(n)] = static_cast<float>(random.uniform(0.2, 1.0));
      picture[n] = static_cast<double>(truth.pixels[static_cast<std::size_t>(n)]);
    }
    for (int m = 0; m < 20; ++m) a.for_each_in_row(m, [&](std::int32_t n, double v) { matrix(m, n) = v; });
    objective.lambda = damping;
    plan.solver = recon::solver_named("tikhonov");
    plan.precision = recon::Precision::f64;
  }
  [[nodiscard]] Reconstructor solver() const { return Reconstructor::create(a, objective, plan).value(); }
  /// (A'A + lambda^2 I)^-1 A' or with lambda itself, whatever tikhonov takes: measured on unit samples.
  [[nodiscard]] Eigen::MatrixXd inverse(const Reconstructor& made) const {
    Eigen::MatrixXd all(30, 20);
    const recon::AlignedWorkspace workspace(made.required_bytes());
    for (int m = 0; m < 20; ++m) {
      std::vector<float> y(20, 0.0F), x(30);
      y[static_cast<std::size_t>(m)] = 1.0F;
      REQUIRE(made.solve(y, {}, workspace.span(), x).health != recon::Health::invalid);
      for (int n = 0; n < 30; ++n) all(n, m) = static_cast<double>(x[static_cast<std::size_t>(n)]);
    }
    return all;
  }
};

}  // namespace

TEST_CASE("of a linear solver, kappa is what the norms of its inverse say") {
  const Linear p;
  const Reconstructor solver = p.solver();
  const Eigen::MatrixXd inverse = p.inverse(solver);
  const Eigen::VectorXd y = p.matrix * p.picture;
  const auto kappa = [&](const Eigen::VectorXd& e) {
    return (inverse * e).squaredNorm() / p.picture.squaredNorm() * y.squaredNorm() / e.squaredNorm();
  };
  const auto found = recon::measure_sensitivity(p.a, solver, p.truth, 1e-2).value();
  CHECK(found.common_gain == doctest::Approx(kappa(y)).epsilon(1e-3));
  CHECK(found.offset == doctest::Approx(kappa(Eigen::VectorXd::Ones(20))).epsilon(1e-3));
  // Of white errors the mean is ||inverse||_F^2; four draws of twenty numbers come within a factor of two.
  const double white = inverse.squaredNorm() / 20.0 / p.picture.squaredNorm() * y.squaredNorm();
  CHECK(found.white > 0.5 * white);
  CHECK(found.white < 2.0 * white);
  CHECK(found.per_channel > 0.3 * white);
  CHECK(found.per_channel < 3.0 * white);
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(30);
  for (int n = 0; n < 30; ++n) {
    const int c = n % 5, left = c == 0 ? n : n - 1, right = c == 4 ? n : n + 1;
    moved[n] = (p.picture[right] - p.picture[left]) / 2.0;
  }
  CHECK(found.row_shape >= kappa(p.matrix * moved) * (1.0 - 1e-3));
}

TEST_CASE("sensitivity is refused where there is nothing to be sensitive about, and stops when asked") {
  const Linear p;
  const Reconstructor solver = p.solver();
  const auto of = [&](const hal::Image& truth, double sigma) {
    return recon::measure_sensitivity(p.a, solver, truth, sigma);
  };
  test::check_error(of(hal::Image(6, 5), 1e-2), hal::ErrorCode::out_of_range, "sensitivity", {});
  test::check_error(of(p.truth, 0.0), hal::ErrorCode::out_of_range, "sensitivity", {});
  test::check_error(of(p.truth, std::nan("")), hal::ErrorCode::out_of_range, "sensitivity", {});
  test::check_error(of(hal::Image(5, 6, 1.0F), 1e-2), hal::ErrorCode::mismatch, "sensitivity", {"5x6", "6x5"});
  const auto stopped =
      recon::measure_sensitivity(p.a, solver, p.truth, 1e-2, [](std::string_view, double, double) { return false; });
  test::check_error(stopped, hal::ErrorCode::interrupted, "sensitivity", {});
}
