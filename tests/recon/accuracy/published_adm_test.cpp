#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/nominal.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;
using recon::solver_named;
using recon::SolverKind;

namespace {

recon::Response small_eye(double acceptance_deg, double scale) {
  constexpr double deg = std::numbers::pi / 180.0;
  hal::EyeGeometry eye;
  eye.interommatidial_rad = 1.5 * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  const recon::Response a = calib::nominal_response(eye, {16, 16, 8.0, 8.0, 30.0}).value();
  const auto rows = a.seeing_rows();
  return a.select_rows(rows, std::vector<double>(rows.size(), scale));
}

struct Tally {
  int black = 0;      ///< x = 0 handed out as the solution
  int recovered = 0;  ///< NMSE below 1e-3
};

/// Twenty scenes of ten dots without noise, y = A x exactly.
Tally tally(SolverKind kind, double acceptance_deg, double scale, int iterations) {
  const recon::Response a = small_eye(acceptance_deg, scale);
  recon::Objective objective;
  objective.lambda = 1e-5 * scale * scale;
  recon::Plan plan;
  plan.solver = kind;
  plan.iterations = iterations;
  plan.precision = recon::Precision::f64;
  const auto solver = recon::Reconstructor::create(a, objective, plan).value();
  Random random(5);
  Tally all;
  for (int t = 0; t < 20; ++t) {
    std::vector<double> x(256, 0.0), y(static_cast<std::size_t>(a.rows()));
    for (int k = 0; k < 10; ++k) x[static_cast<std::size_t>(random.below(256))] = random.uniform(0.3, 1.0);
    a.forward(x, y);
    const SolvedFrame frame = solve_frame(solver, to_float(y));
    double error = 0.0, size = 0.0, found = 0.0;
    for (std::size_t k = 0; k < 256; ++k) {
      const double v = static_cast<double>(frame.x[k]);
      error += (v - x[k]) * (v - x[k]);
      size += x[k] * x[k];
      found += v * v;
    }
    if (found < 1e-6 * size) ++all.black;
    if (error < 1e-3 * size) ++all.recovered;
  }
  return all;
}

}  // namespace

// Inverse crimes on purpose: this is about solvers, on the problem of Lee et al. 2016, figure 4.
TEST_CASE("adm as published calls black a solution where receptive fields overlap, unless A is made small first") {
  CHECK(tally(solver_named("adm as published"), 4.0, 1.0, 9999).black == 0);
  const Tally at_8 = tally(solver_named("adm as published"), 8.0, 1.0, 9999);
  CHECK(at_8.black >= 10);
  CHECK(at_8.recovered == 20 - at_8.black);
  CHECK(tally(solver_named("adm as published"), 17.0, 1.0, 9999).black == 20);
  CHECK(tally(solver_named("adm as published"), 8.0, 0.01, 9999).black == 0);
}

TEST_CASE("adm recovers the same scenes at any scale of A, in a fixed number of iterations") {
  for (const double scale : {1.0, 0.01, 100.0}) {
    const Tally at_8 = tally(solver_named("adm"), 8.0, scale, 1000);
    CHECK(at_8.black == 0);
    CHECK(at_8.recovered == 20);
    CHECK(tally(solver_named("adm"), 17.0, scale, 1000).recovered == 20);
  }
}
