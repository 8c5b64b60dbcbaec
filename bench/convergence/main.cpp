// How long a frame takes that is as good as a converged one: at the rule's lambda, the fewest iterations from which on
// NMSE stays within 5 % of its value after ten times the iterations looked at (better than that counts as within), the
// mean over all scenes and the 90th percentile, and the time of that frame; and what FISTA and the paper's ADM on
// Eigen's matrix take for the same.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/bandwidth.hpp"
#include "bench/convergence/cases.hpp"
#include "bench/convergence/first_order_baseline.hpp"
#include "bench/convergence/trial.hpp"
#include "bench/json_text.hpp"
#include "bench/timing.hpp"
#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "firmware/text/table.hpp"
#include "recon/option_names.hpp"

using namespace compueye;

namespace {

constexpr std::uint64_t build_seed = 7;

struct Measured {
  bench::FrameCase of;
  bench::Curve curve;
  std::string op;
  int iterations = 0;  ///< 0: not within `most`
  double ms = 0.0;
  double excess = 0.0;
  double set_up_s = 0.0;
  std::size_t table_bytes = 0, workspace_bytes = 0;
};

hal::Result<Measured> measure(const bench::FrameCase& c) {
  const auto response = c.measured ? calib::plausible_response(c.eye.geometry, c.eye.plane, {}, build_seed)
                                   : calib::nominal_response(c.eye.geometry, c.eye.plane);
  if (!response) return tl::unexpected(response.error());
  const auto samples = bench::draw_samples(*response, c.eye, c.scenes);
  Measured measured;
  measured.of = c;
  hal::Result<std::vector<recon::Reconstructor>> solvers = hal::fail(hal::ErrorCode::usage, "", "");
  measured.set_up_s =
      1e-3 * bench::milliseconds([&] { solvers = make_solvers(*response, c.objective, c.plan, samples); });
  if (!solvers) return tl::unexpected(solvers.error());
  recon::Reconstructor& first = solvers->front();
  first.forget_modes();
  measured.op = recon::name(first.operating_point().op);
  measured.table_bytes = first.table_bytes();
  measured.workspace_bytes = first.required_bytes();
  measured.curve = bench::measure_curve(*solvers, samples, c.most);
  measured.iterations = c.mean_within_one ? measured.curve.mean_within(0.01) : measured.curve.within(0.05);
  if (measured.iterations == 0) return measured;
  for (const bench::Reached& r : measured.curve.reached) {
    if (r.iterations == measured.iterations) measured.excess = r.excess;
  }
  if (auto set = first.set_iterations(measured.iterations); !set) return tl::unexpected(set.error());
  measured.ms = bench::frame_ms(first, samples.front());
  return measured;
}

std::string time_text(double ms) {
  return ms < 1.0 ? fmt::format("{:.1f} us", 1e3 * ms) : fmt::format("{:.2f} ms", ms);
}

void print_table(const std::vector<Measured>& all) {
  firmware::Table table({{"frame", firmware::Align::left},
                         {"iterations"},
                         {"time"},
                         {"asked"},
                         {"aim"},
                         {"frames/s"},
                         {"us an iteration"},
                         {"NMSE converged"},
                         {"objective over it"},
                         {"tables + workspace MB"},
                         {"set-up s"}});
  for (const Measured& m : all) {
    const bool found = m.iterations > 0;
    table.add({m.of.name, found ? std::to_string(m.iterations) : fmt::format("> {}", m.of.most),
               found ? time_text(m.ms) : "-", time_text(m.of.asked_ms), time_text(m.of.aimed_ms),
               found ? fmt::format("{:.1f}", 1e3 / m.ms) : "-",
               found ? fmt::format("{:.2f}", 1e3 * m.ms / m.iterations) : "-",
               fmt::format("{:.4g}", m.curve.converged.mean), found ? fmt::format("{:+.2g}", m.excess) : "-",
               fmt::format("{:.2f} + {:.2f}", 1e-6 * static_cast<double>(m.table_bytes),
                           1e-6 * static_cast<double>(m.workspace_bytes)),
               fmt::format("{:.1f}", m.set_up_s)});
  }
  fmt::print("{}\n", table.text());
}

void print_baseline(const bench::FirstOrderBaseline& b) {
  fmt::print(
      "\n80x80 line art at {}: pdhg (DCT, x >= 0) is within 5 % of converged after {} iterations, {:.2f} ms, mean NMSE "
      "{:.4g}\n",
      b.noise, b.ours, b.ours_ms, b.nmse);
  firmware::Table table({{"for the same NMSE", firmware::Align::left},
                         {"iterations"},
                         {"best NMSE"},
                         {"Eigen's A and A' alone, our flags"},
                         {"times ours"},
                         {"with fast-math"},
                         {"times ours"}});
  for (const bench::Contestant& c : b.contestants) {
    const std::string more = c.iterations > 0 ? "" : "> ";
    table.add({c.name, more + std::to_string(c.iterations > 0 ? c.iterations : c.most), fmt::format("{:.4g}", c.best),
               more + time_text(c.plain_ms), more + fmt::format("{:.0f}", c.plain_ms / b.ours_ms),
               more + time_text(c.fast_ms), more + fmt::format("{:.0f}", c.fast_ms / b.ours_ms)});
  }
  fmt::print("{}", table.text());
}

bench::Json json_of(const bench::FirstOrderBaseline& b) {
  bench::Json json{{"noise", b.noise}, {"iterations", b.ours}, {"ms", b.ours_ms}, {"nmse", b.nmse}};
  for (const bench::Contestant& c : b.contestants) {
    json["contestants"].push_back({{"name", c.name},
                                   {"iterations", c.iterations},
                                   {"most", c.most},
                                   {"best_nmse", c.best},
                                   {"plain_ms", c.plain_ms},
                                   {"fast_ms", c.fast_ms}});
  }
  return json;
}

bench::Json json_of(const Measured& m) {
  bench::Json json{{"frame", m.of.name},
                   {"operator", m.op},
                   {"iterations", m.iterations},
                   {"ms", m.ms},
                   {"asked_ms", m.of.asked_ms},
                   {"aimed_ms", m.of.aimed_ms},
                   {"objective_excess", m.excess},
                   {"converged_nmse_mean", m.curve.converged.mean},
                   {"converged_nmse_90", m.curve.converged.high},
                   {"table_bytes", m.table_bytes},
                   {"workspace_bytes", m.workspace_bytes},
                   {"set_up_s", m.set_up_s}};
  for (const bench::Reached& r : m.curve.reached) {
    json["curve"].push_back(
        {{"iterations", r.iterations}, {"nmse_mean", r.mean}, {"nmse_90", r.high}, {"excess", r.excess}});
  }
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"How long a frame takes that is within 5 % of converged\nExample: bench_convergence --only 80x80"};
  std::string only;
  double rho = 0.0, relaxation = 0.0;
  int rank = 0;
  bool json = false, baseline = false;
  app.add_option("--only", only, "frames whose name holds this text");
  app.add_option("--rho", rho, "in place of the rule");
  app.add_option("--relaxation", relaxation, "in place of 1.7");
  app.add_option("--rank", rank, "modes in place of the rule");
  app.add_flag("--baseline", baseline, "first-order methods on Eigen's sparse matrix besides, some minutes");
  app.add_flag("--json", json);
  CLI11_PARSE(app, argc, argv);
  const double bandwidth = bench::read_bandwidth();
  std::vector<Measured> all;
  bench::Json report{{"read_bandwidth_gigabytes_per_second", bandwidth}};
  for (bench::FrameCase c : bench::frame_cases()) {
    if (c.name.find(only) == std::string::npos) continue;
    c.plan.rho = rho;
    c.plan.rank = rank;
    if (relaxation > 0.0) c.plan.relaxation = relaxation;
    auto measured = measure(c);
    if (!measured) {
      fmt::print(stderr, "{}: {}\n", c.name, measured.error().text());
      return 1;
    }
    report["frames"].push_back(json_of(*measured));
    all.push_back(std::move(*measured));
  }
  if (!json) fmt::print("one core reads memory at {:.2f} GB/s\n\n", bandwidth);
  if (!json && !all.empty()) print_table(all);
  if (baseline) {
    const auto baselines = bench::measure_first_order_baselines(bench::eye_80x80());
    if (!baselines) {
      fmt::print(stderr, "baseline: {}\n", baselines.error().text());
      return 1;
    }
    for (const bench::FirstOrderBaseline& b : *baselines) {
      report["baselines"].push_back(json_of(b));
      if (!json) print_baseline(b);
    }
  }
  if (json) fmt::print("{}", bench::json_text(report));
  return 0;
}
