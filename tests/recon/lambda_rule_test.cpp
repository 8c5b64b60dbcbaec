#include "recon/lambda_rule.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "recon/setup/solver_row.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"

using namespace compueye;
using namespace compueye::recon;
using namespace compueye::tests;

namespace {

Response scaled(const Response& a, double factor) {
  std::vector<std::int32_t> rows(static_cast<std::size_t>(a.rows()));
  std::iota(rows.begin(), rows.end(), 0);
  return a.select_rows(rows, std::vector<double>(rows.size(), factor));
}

double rule(const Response& a, BasisKind basis, double sigma, SolverKind solver = solver_named("admm")) {
  return lambda_by_rule(a, solver, basis, sigma).value();
}

}  // namespace

TEST_CASE("the rule's scales are a median column norm and a mean column sum") {
  const auto a = Response::from_dense(2, 3, {3.0, 0.0, 1.0, 4.0, 2.0, 0.0}).value().with_image(1, 3).value();
  CHECK(lambda_scale(a, BasisKind::identity) == doctest::Approx(2.0));
  for (const BasisKind basis : {BasisKind::dct, BasisKind::haar, BasisKind::db4, BasisKind::dft, BasisKind::tv}) {
    CHECK(lambda_scale(a, basis) == doctest::Approx(10.0 / 3.0));
  }
  CHECK(rule(a, BasisKind::identity, 0.5) == doctest::Approx(1.1 * 0.5 * 2.0));
  CHECK(rule(a, BasisKind::dct, 0.5) == doctest::Approx(0.002 * 0.5 * 10.0 / 3.0));
  CHECK(rule(a, BasisKind::identity, 0.7, solver_named("tikhonov")) == doctest::Approx(4.0));
  CHECK(rule(a, BasisKind::identity, 0.7, solver_named("tsvd")) == doctest::Approx(4.0));
  CHECK(rule(a, BasisKind::identity, 0.5, solver_named("omp")) == rule(a, BasisKind::identity, 0.5));
  CHECK(rule(a, BasisKind::dct, 0.5, solver_named("omp")) > 10.0 * rule(a, BasisKind::dct, 0.5));
}

TEST_CASE("only the norms of atoms need to know the picture of a response") {
  const auto a = Response::from_dense(2, 4, {3.0, 0.0, 1.0, 2.0, 4.0, 2.0, 0.0, 1.0}).value();
  const auto known = a.with_image(2, 2).value();
  for (const BasisKind basis : {BasisKind::identity, BasisKind::dct, BasisKind::tv}) {
    CHECK(rule(a, basis, 0.5) == rule(known, basis, 0.5));
  }
  CHECK(lambda_by_rule(a, solver_named("omp"), BasisKind::dct, 0.5).error().code == hal::ErrorCode::mismatch);
  CHECK(rule(known, BasisKind::dct, 0.5, solver_named("omp")) > 0.0);
}

TEST_CASE("lambda follows the unit of the samples as the objective does") {
  Random random(1);
  const Response a = random_response(random, 30, Picture{1, 40}, 0.4);
  for (const BasisKind basis : {BasisKind::identity, BasisKind::dct, BasisKind::tv}) {
    for (const double sigma : {0.0, 0.01}) {
      CHECK(rule(scaled(a, 8.0), basis, 8.0 * sigma) == doctest::Approx(64.0 * rule(a, basis, sigma)));
    }
    CHECK(rule(a, basis, 0.0) > 0.0);
    CHECK(rule(a, basis, 0.2) == doctest::Approx(2.0 * rule(a, basis, 0.1)));
  }
}

TEST_CASE("white is one unless samples say that their unit is another") {
  Random random(2);
  const Response a = random_response(random, 30, Picture{1, 40}, 0.4);
  std::vector<double> x(40, 0.3), y(30);
  a.forward(x, y);
  for (const double c : {1e-25, 1e-9, 0.01, 1.0, 4095.0, 1e25}) {
    CAPTURE(c);
    std::vector<float> samples, weights(30, 1.0F);
    for (const double value : y) samples.push_back(static_cast<float>(c * value));
    const double wanted = c < 1e-3 || c > 10.0 ? 0.3 * c : 1.0;
    CHECK(white_of_samples(a, samples, {}) == doctest::Approx(wanted).epsilon(1e-5));
    samples[3] = std::nanf("");
    samples[4] = 1e30F;
    weights[3] = weights[4] = 0.0F;
    CHECK(white_of_samples(a, samples, weights) == doctest::Approx(wanted).epsilon(1e-5));
    for (const char* solver : {"admm", "omp", "tikhonov"}) {
      const auto of = [&](double sigma, double white) {
        return lambda_by_rule(a, solver_named(solver), BasisKind::identity, sigma, white).value();
      };
      const double unit = solver_named(solver)->lambda == LambdaUse::variances ? 1.0 : c;
      CHECK(of(0.01 * c, c) == doctest::Approx(unit * of(0.01, 1.0)));
      CHECK(of(0.0, c) == doctest::Approx(unit * of(0.0, 1.0)));
    }
  }
  CHECK(white_of_samples(a, std::vector<float>(30, 0.0F), {}) == 1.0);
}

TEST_CASE("the rule refuses a sigma that is none, and survives an eye that sees nothing") {
  const auto blind = Response::from_csr(2, 3, {0, 0, 0}, {}, {}).value().with_image(1, 3).value();
  CHECK(rule(blind, BasisKind::dct, 0.1) > 0.0);
  for (const double sigma : {-1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    const auto lambda = lambda_by_rule(blind, solver_named("admm"), BasisKind::dct, sigma);
    REQUIRE_FALSE(lambda.has_value());
    CHECK(lambda.error().code == hal::ErrorCode::out_of_range);
  }
}
