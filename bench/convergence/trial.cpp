#include "bench/convergence/trial.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "bench/timing.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/solver_list.hpp"
#include "sim/pictures/built_in_scenes.hpp"
#include "sim/random/random.hpp"

namespace compueye::bench {
namespace {

double nmse(const std::vector<float>& truth, const std::vector<float>& x) {
  double squares = 0.0, errors = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = truth[k], d = x[k] - t;
    squares += t * t;
    errors += d * d;
  }
  return errors / squares;
}

double percentile90(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::ceil(0.9 * static_cast<double>(values.size()))) - 1];
}

struct Outcomes {
  std::vector<double> nmse, objective;
};

Outcomes solve_all(std::vector<recon::Reconstructor>& solvers, const std::vector<Sample>& samples, int iterations,
                   Pictures pictures = Pictures::as_solved) {
  Outcomes outcomes;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    recon::Reconstructor& solver = solvers[std::min(s, solvers.size() - 1)];
    if (!solver.set_iterations(iterations)) continue;
    const recon::AlignedWorkspace memory(solver.required_bytes());
    std::vector<float> x(samples[s].truth.size());
    const recon::FrameInfo info = solver.solve(samples[s].y, {}, memory.span(), x);
    if (pictures == Pictures::cut_to_positive) {
      for (float& value : x) value = std::max(value, 0.0F);
    }
    outcomes.nmse.push_back(nmse(samples[s].truth, x));
    outcomes.objective.push_back(info.objective);
  }
  return outcomes;
}

Reached summary(int iterations, const Outcomes& outcomes, const Outcomes& converged) {
  const auto count = static_cast<double>(outcomes.nmse.size());
  Reached reached;
  reached.iterations = iterations;
  reached.mean = std::accumulate(outcomes.nmse.begin(), outcomes.nmse.end(), 0.0) / count;
  reached.high = percentile90(outcomes.nmse);
  for (std::size_t s = 0; s < outcomes.objective.size(); ++s) {
    reached.excess += (outcomes.objective[s] / converged.objective[s] - 1.0) / count;
  }
  return reached;
}

}  // namespace

std::vector<Sample> draw_samples(const recon::Response& response, const Eye& eye, const Scenes& scenes) {
  std::vector<Sample> samples;
  for (int s = 0; s < scenes.count; ++s) {
    const std::uint64_t seed = scenes.first_seed + static_cast<std::uint64_t>(s);
    const hal::Image truth = sim::render_built_in(scenes.name, eye.plane.rows, eye.plane.cols, seed).value();
    const std::vector<double> x(truth.pixels.begin(), truth.pixels.end());
    std::vector<double> signal(static_cast<std::size_t>(response.rows()));
    response.forward(x, signal);
    const double power = std::inner_product(signal.begin(), signal.end(), signal.begin(), 0.0);
    const double by_snr = std::sqrt(power / response.rows()) * std::pow(10.0, -scenes.snr_db / 20.0);
    Sample sample{truth.pixels, {}, scenes.sigma.value_or(by_snr)};
    for (std::size_t m = 0; m < signal.size(); ++m) {
      sim::RandomStream stream({seed, sim::Draws::read_noise, 0, static_cast<std::uint32_t>(m)});
      sample.y.push_back(static_cast<float>(signal[m] + sample.sigma * stream.gaussian()));
    }
    samples.push_back(std::move(sample));
  }
  return samples;
}

int Curve::within(double share) const {
  int first = 0;
  for (const Reached& r : reached) {
    const bool inside = r.mean <= (1.0 + share) * converged.mean && r.high <= (1.0 + share) * converged.high;
    if (!inside) first = 0;
    if (inside && first == 0) first = r.iterations;
  }
  return first;
}

int Curve::mean_within(double share) const {
  int first = 0;
  for (const Reached& r : reached) {
    const bool inside = r.mean <= (1.0 + share) * converged.mean;
    if (!inside) first = 0;
    if (inside && first == 0) first = r.iterations;
  }
  return first;
}

hal::Result<std::vector<recon::Reconstructor>> make_solvers(const recon::Response& response, recon::Objective objective,
                                                            const recon::Plan& plan,
                                                            const std::vector<Sample>& samples) {
  std::vector<recon::Reconstructor> solvers;
  std::optional<recon::Factor> factor;
  const bool same =
      std::all_of(samples.begin(), samples.end(), [&](const Sample& s) { return s.sigma == samples.front().sigma; });
  for (const Sample& sample : samples) {
    const auto lambda = recon::lambda_by_rule(response, recon::solver_named("admm"), objective.basis, sample.sigma);
    if (!lambda) return tl::unexpected(lambda.error());
    objective.lambda = *lambda;
    auto made = recon::Reconstructor::create(response, objective, plan, factor);
    if (!made) return tl::unexpected(made.error());
    if (made->factor().order > 0) factor = made->factor();
    solvers.push_back(std::move(*made));
    if (same) break;
  }
  return solvers;
}

std::vector<Reached> measure_at(std::vector<recon::Reconstructor>& solvers, const std::vector<Sample>& samples,
                                const std::vector<int>& iterations, Pictures pictures) {
  std::vector<Reached> reached;
  for (const int k : iterations) {
    const Outcomes outcomes = solve_all(solvers, samples, k, pictures);
    reached.push_back(summary(k, outcomes, outcomes));
  }
  return reached;
}

double frame_ms(const recon::Reconstructor& solver, const Sample& sample) {
  const recon::AlignedWorkspace memory(solver.required_bytes());
  std::vector<float> x(sample.truth.size());
  return median_ms([&] { static_cast<void>(solver.solve(sample.y, {}, memory.span(), x)); });
}

Curve measure_curve(std::vector<recon::Reconstructor>& solvers, const std::vector<Sample>& samples, int most) {
  const Outcomes converged = solve_all(solvers, samples, 10 * most);
  Curve curve;
  curve.converged = summary(10 * most, converged, converged);
  for (int k = 1; k <= most; k += std::max(1, k / 20)) {
    curve.reached.push_back(summary(k, solve_all(solvers, samples, k), converged));
  }
  return curve;
}

}  // namespace compueye::bench
