// What rows that are off do to a picture, against what linear algebra says of a linear solver.

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "recon/aligned_workspace.hpp"
#include "recon/row_sensitivity.hpp"
#include "recon/solver_list.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::Reconstructor;
using recon::Response;

namespace {

Reconstructor linear_solver(const Response& a) {
  recon::Objective objective;
  objective.lambda = 0.3;
  recon::Plan plan;
  plan.solver = recon::solver_named("tikhonov");
  plan.precision = recon::Precision::f64;
  return Reconstructor::create(a, objective, plan).value();
}

/// Pixels by unit samples.
Eigen::MatrixXd inverse_of(const Reconstructor& solver) {
  Eigen::MatrixXd all(solver.pixels(), solver.channels());
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  for (int m = 0; m < solver.channels(); ++m) {
    std::vector<float> y(static_cast<std::size_t>(solver.channels()), 0.0F);
    std::vector<float> x(static_cast<std::size_t>(solver.pixels()));
    y[static_cast<std::size_t>(m)] = 1.0F;
    REQUIRE(solver.solve(y, {}, workspace.span(), x).health != recon::Health::invalid);
    for (int n = 0; n < solver.pixels(); ++n) all(n, m) = static_cast<double>(x[static_cast<std::size_t>(n)]);
  }
  return all;
}

}  // namespace

TEST_CASE("of rows of one pixel each, kappas of gain, noise and nothing at all are exact") {
  constexpr int side = 6, count = side * side;
  std::vector<std::int64_t> start(count + 1);
  std::vector<std::int32_t> columns(count);
  std::iota(start.begin(), start.end(), 0);
  std::iota(columns.begin(), columns.end(), 0);
  const Response a =
      Response::from_csr(count, count, start, columns, std::vector<double>(count, 1.0))->with_image(side, side).value();
  const Reconstructor solver = linear_solver(a);
  const double factor = inverse_of(solver)(0, 0);
  REQUIRE(factor < 0.9);
  const hal::Image truth(side, side, 0.5F);
  constexpr double sigma = 1e-2;
  const auto found = recon::measure_row_sensitivity(a, {}, solver, truth, sigma).value();
  CHECK(found.kappa[0] == doctest::Approx(factor * factor).epsilon(1e-4));
  // A pixel by itself has no neighbours to be moved to, and nothing besides.
  for (std::size_t kind = 1; kind < 4; ++kind) CHECK(found.kappa[kind] == doctest::Approx(0.0));
  CHECK(found.noise == doctest::Approx(factor * factor * sigma * sigma / 0.25).epsilon(1e-4));
  CHECK(found.unperturbed == doctest::Approx((1.0 - factor) * (1.0 - factor)).epsilon(1e-4));
}

TEST_CASE("of a linear solver, kappas of rows are what the norms of its inverse say") {
  Random random{162};
  const Response a = random_response(random, 40, Picture{6, 5}, 0.7);
  hal::Image truth(6, 5);
  Eigen::VectorXd picture(30);
  for (int n = 0; n < 30; ++n) {
    truth.pixels[static_cast<std::size_t>(n)] = static_cast<float>(random.uniform(0.2, 1.0));
    picture[n] = static_cast<double>(truth.pixels[static_cast<std::size_t>(n)]);
  }
  const Reconstructor solver = linear_solver(a);
  const Eigen::MatrixXd inverse = inverse_of(solver);
  Eigen::Vector4d expected = Eigen::Vector4d::Zero();
  for (int m = 0; m < a.rows(); ++m) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(30);
    a.for_each_in_row(m, [&](std::int32_t n, double v) { row[n] = v; });
    const auto at = [&](int r, int c) { return r < 0 || c < 0 || r > 5 || c > 4 ? 0.0 : row[5 * r + c]; };
    double middle_r = 0.0, middle_c = 0.0;
    for (int n = 0; n < 30; ++n) {
      middle_r += row[n] * (n / 5) / row.sum();
      middle_c += row[n] * (n % 5) / row.sum();
    }
    Eigen::MatrixXd ways = Eigen::MatrixXd::Zero(30, 4);
    ways.col(0) = row;
    for (int n = 0; n < 30; ++n) {
      const int r = n / 5, c = n % 5;
      if (row[n] == 0.0) continue;
      ways(n, 1) = 0.5 * (at(r, c + 1) - at(r, c - 1));
      ways(n, 2) = 0.5 * (at(r + 1, c) - at(r - 1, c));
      ways(n, 3) = (r - middle_r) * ways(n, 2) + (c - middle_c) * ways(n, 1);
    }
    const Eigen::MatrixXd apart =
        Eigen::HouseholderQR<Eigen::MatrixXd>(ways).householderQ() * Eigen::MatrixXd::Identity(30, 4);
    const Eigen::Vector4d seen = (apart.transpose() * picture).cwiseAbs2();
    expected += inverse.col(m).squaredNorm() * row.squaredNorm() / picture.squaredNorm() * seen;
  }
  const auto found = recon::measure_row_sensitivity(a, {}, solver, truth, 1e-2).value();
  // Four draws of forty numbers.
  const auto near = [](double value, double other) { return value > 0.6 * other && value < 1.6 * other; };
  CHECK(near(found.kappa[0], expected[0]));
  CHECK(near(found.kappa[1], 0.5 * (expected[1] + expected[2])));
  CHECK(near(found.kappa[2], expected[3]));
  CHECK(found.kappa[3] > 0.0);
}

TEST_CASE("sensitivity to rows is refused where sigmas are another response's, and stops when asked") {
  Random random{163};
  const Response a = random_response(random, 10, Picture{4, 3}, 0.7);
  const Reconstructor solver = linear_solver(a);
  const hal::Image truth(4, 3, 0.5F);
  const std::vector<float> two{1.0F, 1.0F};
  test::check_error(recon::measure_row_sensitivity(a, {two, 4.0, {}}, solver, truth, 1e-2), hal::ErrorCode::mismatch,
                    "sensitivity", {"2"});
  test::check_error(recon::measure_row_sensitivity(a, {{}, 0.5, {}}, solver, truth, 1e-2), hal::ErrorCode::out_of_range,
                    "sensitivity", {"0.5"});
  test::check_error(recon::measure_row_sensitivity(a, {}, solver, hal::Image(4, 3), 1e-2), hal::ErrorCode::out_of_range,
                    "sensitivity", {});
  test::check_error(recon::measure_row_sensitivity(a, {}, solver, truth, 1e-2,
                                                   [](std::string_view, double, double) { return false; }),
                    hal::ErrorCode::interrupted, "sensitivity", {});
}
