// What missing channels cost, and how exact it is to leave them out without a new factor: the 80x80 eye, DCT and box,
// K = 20 iterations, 0, 1 and 5 % of the seeing channels missing. The reference is a new solver for the remaining rows
// alone, with the same rho; its factor takes minutes, because an eye with holes has no mirror symmetry left.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "bench/eyes.hpp"
#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "firmware/text/table.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/reconstructor.hpp"
#include "recon/solver_list.hpp"
#include "sim/pictures/built_in_scenes.hpp"

using namespace compueye;

namespace {

constexpr int iterations = 20;
constexpr int frames = 9;
constexpr int side = 160;

struct Figures {
  double share = 0.0;
  int missing = 0;
  double median_ms = 0.0;
  double relative_error = 0.0;
};

std::vector<std::vector<float>> noisy_samples(const recon::Response& response, const hal::Image& scene) {
  const std::vector<double> x(scene.pixels.begin(), scene.pixels.end());
  std::vector<double> clean(static_cast<std::size_t>(response.rows()));
  response.forward(x, clean);
  std::mt19937 engine(20);
  std::normal_distribution<double> noise(0.0, bench::read_noise);
  std::vector<std::vector<float>> samples;
  for (int f = 0; f < frames; ++f) {
    std::vector<float>& y = samples.emplace_back();
    for (const double v : clean) y.push_back(static_cast<float>(v + noise(engine)));
  }
  return samples;
}

/// Weights with `missing` of the seeing channels at 0.
std::vector<float> with_missing(const recon::Response& response, int missing) {
  std::vector<std::int32_t> seeing = response.seeing_rows();
  std::shuffle(seeing.begin(), seeing.end(), std::mt19937(21));
  std::vector<float> weights(static_cast<std::size_t>(response.rows()), 1.0F);
  for (int k = 0; k < missing; ++k) {
    weights[static_cast<std::size_t>(seeing[static_cast<std::size_t>(k)])] = 0.0F;
  }
  return weights;
}

hal::Result<std::vector<float>> refactored(const recon::Response& response, const recon::Reconstructor& solver,
                                           const std::vector<float>& y, const std::vector<float>& weights) {
  std::vector<std::int32_t> rows;
  std::vector<float> samples;
  for (std::size_t m = 0; m < weights.size(); ++m) {
    if (weights[m] == 0.0F) continue;
    rows.push_back(static_cast<std::int32_t>(m));
    samples.push_back(y[m]);
  }
  auto reference = recon::Reconstructor::create(response.select_rows(rows), solver.objective(), solver.plan());
  if (!reference) return tl::unexpected(reference.error());
  const recon::AlignedWorkspace workspace(reference->required_bytes());
  std::vector<float> x(static_cast<std::size_t>(reference->pixels()));
  static_cast<void>(reference->solve(samples, {}, workspace.span(), x));
  return x;
}

double relative_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    difference += std::pow(static_cast<double>(a[k]) - static_cast<double>(b[k]), 2);
    size += std::pow(static_cast<double>(b[k]), 2);
  }
  return std::sqrt(difference / size);
}

/// Times all shares by turns, so that whatever else the machine does meets them alike.
hal::Result<void> time_frames(const recon::Response& response, const recon::Reconstructor& solver,
                              const std::vector<std::vector<float>>& samples, std::vector<Figures>& all) {
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  std::vector<float> x(static_cast<std::size_t>(solver.pixels()));
  static_cast<void>(solver.solve(samples.front(), {}, workspace.span(), x));  // warms the caches
  std::vector<std::vector<double>> times(all.size());
  for (const std::vector<float>& y : samples) {
    for (std::size_t s = 0; s < all.size(); ++s) {
      const std::vector<float> weights = with_missing(response, all[s].missing);
      recon::FrameInfo info;
      times[s].push_back(bench::milliseconds([&] { info = solver.solve(y, weights, workspace.span(), x); }));
      if (info.health == recon::Health::invalid || info.channels_reweighted != all[s].missing) {
        return hal::fail(hal::ErrorCode::mismatch, "bench", "a frame was not solved as planned");
      }
    }
  }
  for (std::size_t s = 0; s < all.size(); ++s) all[s].median_ms = bench::median(times[s]);
  return {};
}

hal::Result<double> error_of_picture(const recon::Response& response, const recon::Reconstructor& solver,
                                     const std::vector<float>& y, int missing) {
  const std::vector<float> weights = with_missing(response, missing);
  const recon::AlignedWorkspace workspace(solver.required_bytes());
  std::vector<float> x(static_cast<std::size_t>(solver.pixels()));
  static_cast<void>(solver.solve(y, weights, workspace.span(), x));
  const auto reference = refactored(response, solver, y, weights);
  if (!reference) return tl::unexpected(reference.error());
  return relative_difference(x, *reference);
}

hal::Result<std::vector<Figures>> measure_all() {
  const bench::Eye eye = bench::eye_80x80();
  const auto response = calib::nominal_response(eye.geometry, eye.plane);
  if (!response) return tl::unexpected(response.error());
  const auto scene = sim::render_built_in("line-art", side, side, 0);
  if (!scene) return tl::unexpected(scene.error());
  recon::Objective objective;
  objective.basis = recon::BasisKind::dct;
  objective.constraint = recon::ConstraintKind::box;
  const auto lambda = recon::lambda_by_rule(*response, recon::solver_named("admm"), objective.basis, bench::read_noise);
  if (!lambda) return tl::unexpected(lambda.error());
  objective.lambda = *lambda;
  recon::Plan plan;
  plan.iterations = iterations;
  const auto solver = recon::Reconstructor::create(*response, objective, plan);
  if (!solver) return tl::unexpected(solver.error());
  const auto samples = noisy_samples(*response, *scene);
  std::vector<Figures> all;
  for (const double share : {0.0, 0.01, 0.05}) {
    all.push_back({share, static_cast<int>(share * solver->seeing_channels()), 0.0, 0.0});
  }
  if (auto timed = time_frames(*response, *solver, samples, all); !timed) return tl::unexpected(timed.error());
  for (Figures& figures : all) {
    const auto error = error_of_picture(*response, *solver, samples.back(), figures.missing);
    if (!error) return tl::unexpected(error.error());
    figures.relative_error = *error;
  }
  return all;
}

std::string table_text(const std::vector<Figures>& all) {
  using firmware::Align;
  firmware::Table table({{"missing"}, {"channels"}, {"median ms a frame"}, {"ratio to 0 %"}, {"error of the picture"}});
  for (const Figures& f : all) {
    table.add({fmt::format("{:.0f} %", 100.0 * f.share), fmt::format("{}", f.missing),
               fmt::format("{:.1f}", f.median_ms), fmt::format("{:.3f}", f.median_ms / all.front().median_ms),
               fmt::format("{:.1e}", f.relative_error)});
  }
  return table.text();
}

std::string json_text(const std::vector<Figures>& all) {
  bench::Json json;
  json["eye"] = "80x80";
  json["iterations"] = iterations;
  json["frames"] = frames;
  for (const Figures& f : all) {
    json["missing"].push_back({{"share", f.share},
                               {"channels", f.missing},
                               {"median_ms", f.median_ms},
                               {"ratio", f.median_ms / all.front().median_ms},
                               {"relative_error", f.relative_error}});
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_reweighting", measure_all, table_text, json_text);
}
