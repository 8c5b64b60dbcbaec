#include "tests/golden/cases.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/solver_list.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/random/random.hpp"
#include "tests/recon/solve_frame.hpp"

namespace compueye::golden {
namespace {

using recon::BasisKind;
using recon::ConstraintKind;
using recon::OperatorKind;
using recon::solver_named;
using recon::SolverKind;

constexpr std::uint64_t seed = 1;
constexpr std::size_t dead_channel = 27;

Case make_case(std::string_view name, const bench::Eye& eye, std::string_view scene, double sigma) {
  Case golden{name, eye, false, scene, sigma, {}, {}};
  golden.objective.constraint = ConstraintKind::box;
  return golden;
}

Case small_eye(std::string_view name, std::string_view scene, BasisKind basis, std::optional<OperatorKind> op) {
  constexpr double lsb = 128.0 / 65535.0;
  Case golden = make_case(name, bench::eye_8x8(), scene, lsb);
  golden.objective.basis = basis;
  golden.plan.iterations = 30;
  golden.plan.op = op;
  return golden;
}

Case measured(Case golden) {
  golden.measured = true;
  return golden;
}

Case large_eye(std::string_view name, std::string_view scene, BasisKind basis, SolverKind solver, int iterations) {
  Case golden = make_case(name, bench::eye_80x80(), scene, bench::read_noise);
  golden.objective.basis = basis;
  golden.plan.solver = solver;
  golden.plan.iterations = iterations;
  golden.plan.max_reweighted = 0;
  return golden;
}

/// y = A x + n, as the solver believes.
std::vector<float> samples(const recon::Response& response, const hal::Image& picture, double sigma) {
  const std::vector<double> x(picture.pixels.begin(), picture.pixels.end());
  std::vector<double> signal(static_cast<std::size_t>(response.rows()));
  response.forward(x, signal);
  std::vector<float> y(signal.size());
  for (std::size_t m = 0; m < y.size(); ++m) {
    sim::RandomStream noise({seed, sim::Draws::read_noise, 0, static_cast<std::uint32_t>(m)});
    y[m] = static_cast<float>(signal[m] + sigma * noise.gaussian());
  }
  return y;
}

hal::Result<recon::Response> response_of(const Case& golden) {
  return golden.measured ? calib::plausible_response(golden.eye.geometry, golden.eye.plane, {}, seed)
                         : calib::nominal_response(golden.eye.geometry, golden.eye.plane);
}

}  // namespace

std::vector<Case> golden_cases() {
  return {
      small_eye("8x8-admm", "fig2", BasisKind::identity, {}),
      measured(small_eye("8x8-measured-admm", "fig2", BasisKind::identity, {})),
      // Plain rows ask for the least stack: for microcontrollers.
      small_eye("8x8-sparse-admm", "fig2", BasisKind::identity, OperatorKind::csr),
      small_eye("8x8-sparse-admm-dct", "bars", BasisKind::dct, OperatorKind::csr),
      measured(small_eye("8x8-dense-admm", "fig2", BasisKind::identity, OperatorKind::dense)),
      large_eye("80x80-admm", "line-art", BasisKind::dct, solver_named("admm"), 60),
      large_eye("80x80-pdhg", "line-art", BasisKind::dct, solver_named("pdhg"), 25),
      large_eye("80x80-cp-tv", "phantom", BasisKind::tv, solver_named("cp"), 30),
  };
}

hal::Result<std::vector<std::byte>> frozen(const Case& golden) {
  const int rows = golden.eye.plane.rows, cols = golden.eye.plane.cols;
  const auto response = response_of(golden);
  if (!response) return tl::unexpected(response.error());
  const auto picture = sim::render_built_in(golden.scene, rows, cols, seed);
  if (!picture) return tl::unexpected(picture.error());
  recon::Objective objective = golden.objective;
  const auto lambda = recon::lambda_by_rule(*response, golden.plan.solver, objective.basis, golden.sigma);
  if (!lambda) return tl::unexpected(lambda.error());
  objective.lambda = *lambda;
  const auto solver = recon::Reconstructor::create(*response, objective, golden.plan);
  if (!solver) return tl::unexpected(solver.error());
  std::vector<float> weights;
  if (golden.measured) {
    weights.assign(static_cast<std::size_t>(response->rows()), 1.0F);
    weights[dead_channel] = 0.0F;
  }
  const std::vector<float> y = samples(*response, *picture, golden.sigma);
  const tests::SolvedFrame solved = tests::solve_frame(*solver, y, weights);
  const float* w = weights.empty() ? nullptr : weights.data();
  return solver->freeze({y.data(), w, solved.x.data(), solved.info.objective});
}

}  // namespace compueye::golden
