#include "bench/lambda_rule/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "bench/lambda_rule/second_pass.hpp"
#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "recon/lambda_by_risk.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/metrics.hpp"
#include "recon/solver_list.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/random/random.hpp"
#include "sim/render/drawn_signals.hpp"

namespace compueye::bench {
namespace {

constexpr std::uint64_t build_seed = 7;

recon::Response response_of(const Case& c) {
  return c.measured ? calib::plausible_response(c.eye, c.object, {}, build_seed).value()
                    : calib::nominal_response(c.eye, c.object).value();
}

double nmse_of(const std::vector<float>& x, const hal::Image& truth) {
  hal::Image picture(truth.rows, truth.cols);
  picture.pixels = x;
  return recon::nmse(truth, picture).value();
}

}  // namespace

double Sweep::best() const {
  return std::min({*std::min_element(nmse.begin(), nmse.end()), at_rule, by_risk});
}

double Sweep::best_multiple() const {
  return multiples[static_cast<std::size_t>(std::min_element(nmse.begin(), nmse.end()) - nmse.begin())];
}

SweptEye::SweptEye(const Case& c) : case_(c), response_(response_of(c)) {}

Sweep SweptEye::sweep(const std::string& scene, std::uint64_t seed, double sigma, bool with_risk) {
  const hal::Image truth = sim::render_built_in(scene, case_.object.rows, case_.object.cols, seed).value();
  const std::vector<float> y = samples(scene, truth, seed, sigma);
  const double rule = this->rule(sigma);
  Sweep result{scene, seed, sigma, {}, {}, 0.0, 0.0, 1.0, 0.0, 0.0};
  for (int k = -case_.grid_below; k <= case_.grid_above; ++k) {
    result.multiples.push_back(std::pow(case_.grid_step, k));
    result.nmse.push_back(nmse_at(rule * result.multiples.back(), y, truth));
  }
  result.at_rule = result.nmse[static_cast<std::size_t>(case_.grid_below)];
  result.by_risk = result.at_rule;
  if (!with_risk) return result;
  if (case_.basis == recon::BasisKind::identity) {
    const std::vector<float> first = solved(case_, response_, objective(rule), y, factor_);
    result.debiased = nmse_of(debiased(case_, response_, y, first), truth);
    result.reweighted = nmse_of(reweighted(case_, response_, y, objective(rule), factor_), truth);
  }
  const auto found = recon::lambda_by_risk(response_, objective(rule), plan(), {y, {}, sigma}, factor_);
  result.risk_multiple = found.value().lambda / rule;
  result.by_risk = nmse_at(found.value().lambda, y, truth);
  return result;
}

double SweptEye::nmse_by_rule(const std::string& scene, std::uint64_t seed, double sigma) {
  const hal::Image truth = sim::render_built_in(scene, case_.object.rows, case_.object.cols, seed).value();
  return nmse_at(rule(sigma), samples(scene, truth, seed, sigma), truth);
}

double SweptEye::rule(double sigma) const {
  return recon::lambda_by_rule(response_, recon::solver_named("admm"), case_.basis, sigma).value();
}

std::vector<float> SweptEye::samples(const std::string& scene, const hal::Image& truth, std::uint64_t seed,
                                     double sigma) const {
  std::vector<double> signal(static_cast<std::size_t>(response_.rows()));
  if (case_.measured || case_.exact) {
    const std::vector<double> x(truth.pixels.begin(), truth.pixels.end());
    response_.forward(x, signal);
  } else {
    signal = sim::drawn_signals(case_.eye, case_.object, sim::scene_on(case_.object, scene, truth)).value();
  }
  std::vector<float> y(signal.size());
  for (std::size_t m = 0; m < y.size(); ++m) {
    sim::RandomStream stream({seed, sim::Draws::read_noise, 0, static_cast<std::uint32_t>(m)});
    y[m] = static_cast<float>(signal[m] + sigma * stream.gaussian());
  }
  return y;
}

recon::Objective SweptEye::objective(double lambda) const {
  recon::Objective objective;
  objective.basis = case_.basis;
  objective.constraint = case_.constraint;
  objective.lambda = lambda;
  return objective;
}

recon::Plan SweptEye::plan() const {
  recon::Plan plan;
  plan.iterations = case_.iterations;
  return plan;
}

double SweptEye::nmse_at(double lambda, const std::vector<float>& y, const hal::Image& truth) {
  return nmse_of(solved(case_, response_, objective(lambda), y, factor_), truth);
}

}  // namespace compueye::bench
