// How many iterations a solver needs, and how long they take: NMSE against iterations at the rule's lambda, from which
// iteration on it stays within 5 % and within 1 % of converged (ten times the iterations), and the time of that frame.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/bandwidth.hpp"
#include "bench/convergence/trial.hpp"
#include "bench/timing.hpp"
#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "firmware/app/report/table.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/option_names.hpp"

using namespace compueye;

namespace {

struct Request {
  std::string eye = "80x80", basis = "dct", constraint = "box", solver = "pdhg";
  bench::Scenes scenes;
  double sigma = 0.0, lambda_multiple = 1.0;
  bool measured = false;
  int most = 100;
  std::vector<double> rhos{0.0}, relaxations{1.7};
  bool brief = false;
  recon::Plan plan;
};

template <class Kind>
Kind kind_of(std::span<const recon::Named<Kind>> names, const std::string& text) {
  for (const auto& named : names) {
    if (named.name == text) return named.kind;
  }
  throw CLI::ValidationError(text, "is not known");
}

bench::Eye eye_of(const std::string& name) {
  if (name == "8x8") return bench::eye_8x8();
  if (name == "120x120") return bench::make_eye("120x120", 120, 1.5, 60.0, {240, 240, 60.0, 60.0, 10.0});
  return bench::eye_80x80();
}

int run(Request& request) {
  const bench::Eye eye = eye_of(request.eye);
  const recon::Response response = request.measured ? calib::plausible_response(eye.geometry, eye.plane, {}, 7).value()
                                                    : calib::nominal_response(eye.geometry, eye.plane).value();
  if (request.sigma > 0.0) request.scenes.sigma = request.sigma;
  const auto samples = bench::draw_samples(response, eye, request.scenes);
  recon::Objective objective;
  objective.basis = kind_of(recon::basis_names(), request.basis);
  objective.constraint = kind_of(recon::constraint_names(), request.constraint);
  request.plan.solver = kind_of(recon::solver_names(), request.solver);
  std::optional<recon::Factor> factor;
  for (double rho : request.rhos)
    for (double relaxation : request.relaxations) {
      request.plan.rho = rho;
      request.plan.relaxation = relaxation;
      std::vector<recon::Reconstructor> solvers;
      const double begun = bench::milliseconds([&] {
        for (const bench::Sample& sample : samples) {
          if (!solvers.empty() && request.scenes.sigma) break;
          objective.lambda =
              request.lambda_multiple * recon::lambda_by_rule(response, eye.plane.rows, eye.plane.cols,
                                                              recon::SolverKind::admm, objective.basis, sample.sigma)
                                            .value();
          auto made =
              recon::Reconstructor::create(response, eye.plane.rows, eye.plane.cols, objective, request.plan, factor);
          if (!made) throw CLI::ValidationError("set-up", made.error().text());
          if (recon::uses_factor(request.plan.solver)) factor = made->factor();
          solvers.push_back(std::move(*made));
        }
      });
      const bench::Curve curve = bench::measure_curve(solvers, samples, request.most);
      fmt::print(
          "th {} {} {} {} {} sigma {:.3g} lambda {:.4g} rho {:.4g} rank {}  op {}  set-up {:.1f} s, tables {} B, "
          "workspace {} B\n",
          relaxation, request.eye, request.scenes.name, request.solver, request.basis, samples.front().sigma,
          objective.lambda, solvers.front().plan().rho, solvers.front().plan().rank,
          recon::name(solvers.front().operating_point().op), begun * 1e-3, solvers.front().table_bytes(),
          solvers.front().required_bytes());
      if (!request.brief)
        for (const bench::Reached& r : curve.reached) {
          fmt::print("{:5d} {:.5f} {:.5f} {:+.3g}\n", r.iterations, r.mean, r.high, r.excess);
        }
      fmt::print("converged {:.5f} {:.5f}; within 5 % from {}, 1 % from {}; the mean alone within 1 % from {}\n",
                 curve.converged.mean, curve.converged.high, curve.within(0.05), curve.within(0.01),
                 curve.mean_within(0.01));
      for (const double share : {0.05, 0.01}) {
        const int k = curve.within(share);
        if (k == 0) continue;
        recon::Reconstructor& solver = solvers.front();
        if (!solver.set_iterations(k)) return 1;
        const bench::Workspace memory(solver.required_bytes());
        std::vector<float> x(samples.front().truth.size());
        const double ms =
            bench::median_ms([&] { static_cast<void>(solver.solve(samples.front().y, {}, memory.span(), x)); });
        fmt::print("{:.0f} %: {} iterations, {:.3f} ms, {:.1f} frames/s, {:.1f} us an iteration\n", 100 * share, k, ms,
                   1e3 / ms, 1e3 * ms / k);
      }
    }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  CLI::App app{"How many iterations a solver needs, and how long they take"};
  app.add_option("--eye", request.eye, "8x8, 80x80 or 120x120");
  app.add_option("--basis", request.basis);
  app.add_option("--constraint", request.constraint);
  app.add_option("--solver", request.solver);
  app.add_option("--scene", request.scenes.name);
  app.add_option("--scenes", request.scenes.count);
  app.add_option("--seed", request.scenes.first_seed);
  app.add_option("--sigma", request.sigma);
  app.add_option("--snr", request.scenes.snr_db);
  app.add_option("--most", request.most);
  app.add_option("--rho", request.rhos)->delimiter(',');
  app.add_flag("--brief", request.brief);
  app.add_option("--lambda-multiple", request.lambda_multiple);
  app.add_option("--rank", request.plan.rank);
  app.add_option("--relaxation", request.relaxations)->delimiter(',');
  app.add_flag("--measured", request.measured);
  CLI11_PARSE(app, argc, argv);
  return run(request);
}
