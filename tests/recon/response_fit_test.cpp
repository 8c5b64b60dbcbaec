#include "recon/response_fit.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "recon/option_names.hpp"
#include "recon/solver_list.hpp"
#include "tests/recon/random_problem.hpp"
#include "tests/recon/solve_frame.hpp"

using namespace compueye;
using namespace compueye::tests;

namespace {

constexpr Picture picture{8, 8};
constexpr int fitted_channels = 40;
constexpr double noise_sigma = 0.01;

struct Samples {
  std::vector<float> y;
  double noise = 0.0;  // over what sigma makes us expect
};

Samples samples_of(const recon::Response& response, Random& random) {
  std::vector<double> y(fitted_channels);
  response.forward(random_vector(random, response.cols(), 0.0, 1.0), y);
  double squares = 0.0;
  for (double& value : y) {
    const double noise = noise_sigma * random.normal();
    squares += noise * noise;
    value += noise;
  }
  return {to_float(y), std::sqrt(squares / fitted_channels) / noise_sigma};
}

struct Solver {
  const char* name;
  recon::ConstraintKind constraint;
  int iterations;
};
constexpr Solver fitted_solvers[]{
    {"admm", recon::ConstraintKind::box, 1},        {"admm", recon::ConstraintKind::nonnegative, 300},
    {"pdhg", recon::ConstraintKind::box, 5},        {"fista", recon::ConstraintKind::none, 3},
    {"fista", recon::ConstraintKind::box, 5000},    {"tikhonov", recon::ConstraintKind::none, 1},
    {"adm", recon::ConstraintKind::nonnegative, 20}};

recon::Reconstructor reconstructor_of(const recon::Response& response, const Solver& solver, double lambda) {
  recon::Objective objective;
  objective.basis = recon::BasisKind::identity;
  objective.constraint = solver.constraint;
  objective.lambda = lambda;
  recon::Plan plan;
  plan.solver = *recon::kind_of(recon::solver_names(), solver.name);
  plan.iterations = solver.iterations;
  return recon::Reconstructor::create(response, objective, plan).value();
}

recon::ResponseFit fit_of(const recon::Reconstructor& reconstructor, const std::vector<float>& y,
                          const std::vector<float>& weights = {}) {
  const SolvedFrame frame = solve_frame(reconstructor, y, weights);
  return recon::ResponseFitter(reconstructor, noise_sigma).fit(frame.info, y, weights, frame.x);
}

}  // namespace

TEST_CASE("noise alone is never taken for a misfit, however few the iterations and large the penalty") {
  Random random(5);
  const recon::Response response = random_response(random, fitted_channels, picture, 0.3);
  bool far = false;
  for (const Solver& solver : fitted_solvers) {
    for (const double lambda : {1e-4, 1.0}) {
      CAPTURE(solver.name);
      const auto reconstructor = reconstructor_of(response, solver, lambda);
      for (int n = 0; n < 20; ++n) {
        const Samples samples = samples_of(response, random);
        const recon::ResponseFit fit = fit_of(reconstructor, samples.y);
        CHECK(fit.least <= samples.noise * 1.001 + 1e-3);
        CHECK_FALSE(fit.misfit());
        far = far || fit.residual > 100.0;
      }
    }
  }
  CHECK(far);  // a bare residual would have cried wolf
}

TEST_CASE("samples of another eye are told by what no picture can explain") {
  Random random(6);
  // More channels than pixels, or a picture could explain anything.
  const recon::Response theirs = random_response(random, fitted_channels, Picture{4, 8}, 0.3);
  const recon::Response ours = random_response(random, fitted_channels, Picture{4, 8}, 0.3);
  const auto reconstructor = reconstructor_of(ours, {"admm", recon::ConstraintKind::box, 300}, 1e-4);
  for (int n = 0; n < 20; ++n) {
    const recon::ResponseFit fit = fit_of(reconstructor, samples_of(theirs, random).y);
    CHECK(fit.misfit());
    CHECK(fit.least <= fit.residual * 1.0001);
    CHECK(fit.least > 0.8 * fit.residual);
  }
}

TEST_CASE("a channel of weight zero, an unsolved frame and a sigma of nothing tell no misfit") {
  Random random(7);
  const recon::Response response = random_response(random, fitted_channels, picture, 0.3);
  const auto reconstructor = reconstructor_of(response, {"admm", recon::ConstraintKind::box, 50}, 1e-4);
  Samples samples = samples_of(response, random);
  std::vector<float> weights(fitted_channels, 1.0F);
  weights[3] = 0.0F;
  const recon::ResponseFit before = fit_of(reconstructor, samples.y, weights);
  samples.y[3] = std::numeric_limits<float>::quiet_NaN();
  const recon::ResponseFit after = fit_of(reconstructor, samples.y, weights);
  CHECK(after.residual == before.residual);
  CHECK(after.least == before.least);
  const recon::ResponseFit unsolved = fit_of(reconstructor, samples.y);
  CHECK(unsolved.residual == 0.0);
  CHECK(unsolved.least == 0.0);
  samples.y.assign(fitted_channels, 0.0F);
  const SolvedFrame frame = solve_frame(reconstructor, samples.y);
  CHECK(recon::ResponseFitter(reconstructor, 0.0).fit(frame.info, samples.y, {}, frame.x).residual == 0.0);
}
