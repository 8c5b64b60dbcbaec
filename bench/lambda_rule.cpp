// How far lambda by rule lands from the best lambda, and where the rule's factors come from: a sweep of lambda on
// tuning scenes (to choose the factor) and on evaluation scenes with other seeds (to judge it). The light goes through
// sim's optics, the reconstruction uses calib's response. Run with --help for the options.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <new>
#include <numbers>
#include <string>
#include <vector>

#include "calib/nominal.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/metrics.hpp"
#include "sim/built_in_scenes.hpp"
#include "sim/optics.hpp"
#include "sim/random.hpp"

using namespace compueye;

namespace {

constexpr double deg = std::numbers::pi / 180.0;

struct Setup {
  std::string name;
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  recon::BasisKind basis;
  recon::ConstraintKind constraint;
  int iterations;
  std::vector<double> sigmas;
  std::vector<std::string> scenes;
  bool large;
};

std::vector<Setup> setups() {
  hal::EyeGeometry small;
  small.interommatidial_rad = 1.5 * deg;
  small.acceptance_rad = 8.0 * deg;
  hal::EyeGeometry narrow = small;
  narrow.acceptance_rad = 4.0 * deg;
  hal::EyeGeometry medium = small;
  medium.rows = medium.columns = 32;
  medium.interommatidial_rad = 5.625 * deg;
  medium.acceptance_rad = 60.0 * deg;
  hal::EyeGeometry large = medium;
  large.rows = large.columns = 80;
  large.interommatidial_rad = 2.25 * deg;
  const hal::ObjectPlane near{16, 16, 8, 8, 30}, middle{64, 64, 60, 60, 10}, wide{160, 160, 60, 60, 10};
  const std::vector<std::string> sparse{"dots"}, drawn{"line-art", "phantom", "bars"};
  using recon::BasisKind;
  using recon::ConstraintKind;
  return {
      {"8x8/8deg pixels",
       small,
       near,
       BasisKind::identity,
       ConstraintKind::nonnegative,
       400,
       {.02, .1, .3},
       sparse,
       false},
      {"8x8/4deg pixels", narrow, near, BasisKind::identity, ConstraintKind::box, 400, {.02, .1, .3}, sparse, false},
      {"8x8/8deg dct", small, near, BasisKind::dct, ConstraintKind::box, 400, {.02, .1, .3}, drawn, false},
      {"32x32/60deg dct", medium, middle, BasisKind::dct, ConstraintKind::box, 200, {.05, .3, 1.}, drawn, false},
      {"80x80/60deg dct", large, wide, BasisKind::dct, ConstraintKind::box, 60, {.1, .316, 1.}, drawn, true},
  };
}

/// NMSE of one noisy scene at each multiple of sigma * median atom norm.
struct Sweep {
  std::string scene;
  std::uint64_t seed;
  double sigma;
  std::vector<double> nmse;
};

std::vector<double> factors() {
  std::vector<double> all{0.05};
  while (all.back() * std::sqrt(2.0) < 7.0) all.push_back(all.back() * std::sqrt(2.0));
  return all;
}

class Eye {
 public:
  explicit Eye(const Setup& setup)
      : setup_(setup), response_(calib::nominal_response(setup.eye, setup.object).value()) {
    norm_ = recon::median_atom_norm(response_, setup.object.rows, setup.object.cols, setup.basis);
  }

  [[nodiscard]] Sweep sweep(const std::string& scene, std::uint64_t seed, double sigma) {
    const hal::Image truth = sim::render_built_in(scene, setup_.object.rows, setup_.object.cols, seed).value();
    const sim::Optics optics{setup_.eye, setup_.object, sim::AngularProfile::flat_top(setup_.eye.acceptance_rad)};
    const std::vector<double> signal = optics.expose(sim::scene_on(setup_.object, scene, truth)).value();
    std::vector<float> y(signal.size());
    for (std::size_t m = 0; m < y.size(); ++m) {
      sim::RandomStream stream({seed, sim::Effect::read_noise, 0, static_cast<std::uint32_t>(m)});
      y[m] = static_cast<float>(signal[m] + sigma * stream.gaussian());
    }
    Sweep result{scene, seed, sigma, {}};
    for (const double c : factors()) result.nmse.push_back(nmse_at(c * sigma * norm_, y, truth));
    return result;
  }

 private:
  double nmse_at(double lambda, const std::vector<float>& y, const hal::Image& truth) {
    recon::Objective objective;
    objective.basis = setup_.basis;
    objective.constraint = setup_.constraint;
    objective.lambda = lambda;
    recon::Plan plan;
    plan.iterations = setup_.iterations;
    const auto solver = recon::Reconstructor::create(response_, setup_.object.rows, setup_.object.cols, objective, plan,
                                                     have_factor_ ? std::optional(factor_) : std::nullopt)
                            .value();
    if (!have_factor_) factor_ = solver.factor();
    have_factor_ = true;
    const std::size_t bytes = solver.required_bytes();
    auto* memory = static_cast<std::byte*>(::operator new (bytes, std::align_val_t{64}));
    hal::Image picture(truth.rows, truth.cols);
    static_cast<void>(solver.solve(y, {}, {memory, bytes}, picture.pixels));
    ::operator delete (memory, std::align_val_t{64});
    return recon::nmse(truth, picture).value();
  }

  const Setup& setup_;
  recon::Response response_;
  double norm_ = 0.0;
  recon::Factor factor_;
  bool have_factor_ = false;
};

std::vector<Sweep> sweep_all(Eye& eye, const Setup& setup, std::uint64_t first_seed, int count) {
  std::vector<Sweep> all;
  for (const double sigma : setup.sigmas) {
    for (int s = 0; s < count; ++s) {
      const std::string& scene = setup.scenes[static_cast<std::size_t>(s) % setup.scenes.size()];
      all.push_back(eye.sweep(scene, first_seed + static_cast<std::uint64_t>(s), sigma));
      fmt::print(stderr, "\r{}: {} {}   ", setup.name, sigma, s);
    }
  }
  fmt::print(stderr, "\r{:60}\r", "");
  return all;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// NMSE at factor c over the sweep's best.
double excess(const Sweep& sweep, std::size_t c) {
  return sweep.nmse[c] / *std::min_element(sweep.nmse.begin(), sweep.nmse.end());
}

void print_tuning(const Setup& setup, const std::vector<Sweep>& sweeps) {
  fmt::print("{}: tuning scenes, median NMSE / best NMSE at lambda = c sigma norm\n ", setup.name);
  const std::vector<double> cs = factors();
  for (std::size_t c = 0; c < cs.size(); ++c) {
    std::vector<double> ratios;
    ratios.reserve(sweeps.size());
    for (const Sweep& sweep : sweeps) ratios.push_back(excess(sweep, c));
    fmt::print(" {:.2f}:{:.3f}", cs[c], median(ratios));
  }
  fmt::print("\n");
}

void print_evaluation(const Setup& setup, const std::vector<Sweep>& sweeps, double rule_factor) {
  const std::vector<double> cs = factors();
  std::size_t at = 0;
  for (std::size_t c = 1; c < cs.size(); ++c) {
    if (std::abs(std::log(cs[c] / rule_factor)) < std::abs(std::log(cs[at] / rule_factor))) at = c;
  }
  std::vector<double> ratios;
  fmt::print("{}: evaluation scenes, rule's factor {} (grid {:.2f})\n", setup.name, rule_factor, cs[at]);
  fmt::print("  {:10} {:>5} {:>7} {:>9} {:>9} {:>7} {:>6}\n", "scene", "seed", "sigma", "NMSE", "best", "ratio",
             "best c");
  for (const Sweep& sweep : sweeps) {
    const auto best = std::min_element(sweep.nmse.begin(), sweep.nmse.end());
    ratios.push_back(excess(sweep, at));
    fmt::print("  {:10} {:>5} {:>7} {:>9.5f} {:>9.5f} {:>7.3f} {:>6.2f}\n", sweep.scene, sweep.seed, sweep.sigma,
               sweep.nmse[at], *best, ratios.back(), cs[static_cast<std::size_t>(best - sweep.nmse.begin())]);
  }
  fmt::print("  median ratio {:.3f}, worst {:.3f}\n\n", median(ratios),
             *std::max_element(ratios.begin(), ratios.end()));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"How far lambda by rule lands from the best lambda"};
  bool full = false;
  int scenes = 10;
  std::string only;
  app.add_flag("--full", full, "the 80x80 eye too (several minutes)");
  app.add_option("--scenes", scenes, "scenes a noise level")->check(CLI::Range(1, 1000));
  app.add_option("--only", only, "only set-ups whose name contains this");
  app.footer("Example: bench_lambda_rule --full --only dct");
  CLI11_PARSE(app, argc, argv);
  for (const Setup& setup : setups()) {
    if ((setup.large && !full) || setup.name.find(only) == std::string::npos) continue;
    Eye eye(setup);
    const auto lambda =
        recon::lambda_by_rule(calib::nominal_response(setup.eye, setup.object).value(), setup.object.rows,
                              setup.object.cols, recon::SolverKind::admm, setup.basis, 1.0)
            .value();
    const double norm = recon::median_atom_norm(calib::nominal_response(setup.eye, setup.object).value(),
                                                setup.object.rows, setup.object.cols, setup.basis);
    print_tuning(setup, sweep_all(eye, setup, 1001, scenes));
    print_evaluation(setup, sweep_all(eye, setup, 1, scenes), lambda / norm);
  }
  return 0;
}
