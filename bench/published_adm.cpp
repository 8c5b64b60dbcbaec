// What YALL1 v1.4 does on overlapping receptive fields, beside adm: figure 4 of Lee et al. 2016. Sparse scenes without
// noise, y = A x exactly (an inverse crime: this is about solvers), by acceptance angle.

#include <fmt/core.h>

#include <numbers>
#include <vector>

#include "bench/eyes.hpp"
#include "bench/json_text.hpp"
#include "bench/print_measured.hpp"
#include "bench/timing.hpp"
#include "calib/nominal.hpp"
#include "firmware/text/table.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/metrics.hpp"
#include "recon/reconstructor.hpp"
#include "recon/solver_list.hpp"
#include "sim/random/random.hpp"

using namespace compueye;

namespace {

constexpr int scenes = 100;
constexpr int dots = 10;
constexpr double lambda = 1e-5;

struct Way {
  const char* name;
  recon::SolverKind solver;
  bool normalised;  // A over its Frobenius norm
  int iterations;
};

const Way ways[] = {{"as published", recon::solver_named("adm as published"), false, 9999},
                    {"as published, A / ||A||", recon::solver_named("adm as published"), true, 9999},
                    {"adm, 1000 iterations", recon::solver_named("adm"), false, 1000}};

struct Figures {
  double acceptance_deg = 0.0;
  double black_share[3] = {};  // x = 0 called the solution
  double nmse[3] = {};         // mean
  double iterations[3] = {};   // median
};

hal::Image sparse_scene(int index) {
  hal::Image scene(16, 16);
  sim::RandomStream stream({1, sim::Draws::picture, static_cast<std::uint64_t>(index), 0});
  for (int k = 0; k < dots; ++k) {
    scene.pixels[stream.below(256)] = static_cast<float>(stream.uniform(0.3, 1.0));
  }
  return scene;
}

recon::Response scaled(const recon::Response& a, bool normalised) {
  double squares = 0.0;
  for (const double v : a.values()) squares += v * v;
  const auto rows = a.seeing_rows();
  return a.select_rows(rows, std::vector<double>(rows.size(), normalised ? 1.0 / std::sqrt(squares) : 1.0));
}

hal::Result<void> measure(const Way& way, std::size_t w, const recon::Response& nominal, Figures& figures) {
  const recon::Response a = scaled(nominal, way.normalised);
  const double unit = a.values()[0] / nominal.select_rows(nominal.seeing_rows()).values()[0];
  recon::Objective objective;
  objective.lambda = lambda * unit * unit;
  recon::Plan plan;
  plan.solver = way.solver;
  plan.iterations = way.iterations;
  plan.precision = recon::Precision::f64;
  const auto solver = recon::Reconstructor::create(a, objective, plan);
  if (!solver) return tl::unexpected(solver.error());
  const recon::AlignedWorkspace workspace(solver->required_bytes());
  std::vector<double> iterations;
  for (int s = 0; s < scenes; ++s) {
    const hal::Image truth = sparse_scene(s);
    const std::vector<double> x(truth.pixels.begin(), truth.pixels.end());
    std::vector<double> y(static_cast<std::size_t>(a.rows()));
    a.forward(x, y);
    hal::Image found(16, 16);
    const auto info = solver->solve(std::vector<float>(y.begin(), y.end()), {}, workspace.span(), found.pixels);
    const auto error = recon::nmse(found, truth);
    if (!error) return tl::unexpected(error.error());
    double size = 0.0;
    for (const float v : found.pixels) size += static_cast<double>(v) * static_cast<double>(v);
    figures.black_share[w] += size < 1e-6 ? 1.0 / scenes : 0.0;
    figures.nmse[w] += *error / scenes;
    iterations.push_back(info.iterations);
  }
  figures.iterations[w] = bench::median(std::move(iterations));
  return {};
}

hal::Result<std::vector<Figures>> measure_all() {
  std::vector<Figures> all;
  for (const double acceptance : {1.5, 3.0, 4.0, 5.0, 8.0, 11.0, 14.0, 17.0, 20.0}) {
    const bench::Eye eye = bench::make_eye("8x8", 8, 1.5, acceptance, bench::eye_8x8().plane);
    const auto response = calib::nominal_response(eye.geometry, eye.plane);
    if (!response) return tl::unexpected(response.error());
    Figures figures;
    figures.acceptance_deg = acceptance;
    for (std::size_t w = 0; w < std::size(ways); ++w) {
      if (auto done = measure(ways[w], w, *response, figures); !done) return tl::unexpected(done.error());
    }
    all.push_back(figures);
  }
  return all;
}

std::string table_text(const std::vector<Figures>& all) {
  firmware::Table table(
      {{"acceptance deg"}, {"method", firmware::Align::left}, {"x = 0"}, {"mean NMSE"}, {"iterations"}});
  for (const Figures& f : all) {
    for (std::size_t w = 0; w < std::size(ways); ++w) {
      table.add({fmt::format("{:g}", f.acceptance_deg), ways[w].name, fmt::format("{:.0f} %", 100.0 * f.black_share[w]),
                 fmt::format("{:.2g}", f.nmse[w]), fmt::format("{:.0f}", f.iterations[w])});
    }
  }
  return table.text();
}

std::string json_text(const std::vector<Figures>& all) {
  bench::Json json;
  json["scenes"] = scenes;
  json["dots"] = dots;
  json["lambda"] = lambda;
  for (const Figures& f : all) {
    for (std::size_t w = 0; w < std::size(ways); ++w) {
      json["points"].push_back({{"acceptance_deg", f.acceptance_deg},
                                {"method", ways[w].name},
                                {"black_share", f.black_share[w]},
                                {"mean_nmse", f.nmse[w]},
                                {"median_iterations", f.iterations[w]}});
    }
  }
  return bench::json_text(json);
}

}  // namespace

int main(int argc, char** argv) {
  return bench::print_measured(argc, argv, "bench_published_adm", measure_all, table_text, json_text);
}
