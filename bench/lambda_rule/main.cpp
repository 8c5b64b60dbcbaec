// How far lambda by rule, and lambda by risk, land from the best lambda: every figure of docs/lambda-rule.md. A sweep
// of lambda on evaluation scenes judges them; with --tuning a sweep on scenes and noise levels of their own shows where
// the rule's factors come from. Run with --help for the options.

#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/lambda_rule/cases.hpp"
#include "bench/lambda_rule/family.hpp"
#include "bench/lambda_rule/sweep.hpp"
#include "bench/lambda_rule/tables.hpp"

using namespace compueye;

namespace {

struct Options {
  bool full = false;
  bool tuning = false;
  bool each = false;
  bool paper_noise = false;
  bool family = false;
  std::vector<std::string> only;
};

bool wanted(const bench::Case& c, const Options& options) {
  if (c.large && !options.full) return false;
  for (const std::string& part : options.only) {
    if (c.name.find(part) == std::string::npos) return false;
  }
  return true;
}

std::vector<bench::Sweep> sweep_all(const bench::Case& c, bool tuning) {
  bench::SweptEye eye(c);
  std::vector<bench::Sweep> all;
  const std::uint64_t first_seed = tuning ? 1001 : 1;
  for (const double sigma : tuning ? c.tuning_sigmas : c.evaluation_sigmas) {
    for (const std::string& scene : c.scenes) {
      for (int s = 0; s < c.seeds; ++s) {
        if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r{:70}\r{}: sigma {}, {} {}", "", c.name, sigma, scene, s);
        all.push_back(eye.sweep(scene, first_seed + static_cast<std::uint64_t>(s), sigma, !tuning));
      }
    }
  }
  if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r{:70}\r", "");
  return all;
}

void print_paper_noise() {
  for (const bench::Case& c : bench::paper_cases()) {
    bench::SweptEye eye(c);
    for (const std::string& scene : c.scenes) {
      const double nmse = eye.nmse_by_rule(scene, 0, c.evaluation_sigmas.front());
      fmt::print("{}, {} iterations, {}, sigma^2 = .1: NMSE {:.4f} by rule\n", c.name, c.iterations, scene, nmse);
    }
  }
}

void print_family(const Options& options) {
  if (!options.tuning) bench::print_family_head();
  for (const bench::Case& c : bench::family_cases()) {
    if (!wanted(c, options)) continue;
    if (options.tuning) {
      bench::print_family_points(c);
    } else {
      bench::print_family_scores(c, options.each);
    }
    static_cast<void>(std::fflush(stdout));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"How far lambda by rule lands from the best lambda"};
  Options options;
  app.add_flag("--full", options.full, "the 80x80 eye too (minutes a case)");
  app.add_flag("--tuning", options.tuning, "the scenes and noise levels that the rule's factors were chosen on");
  app.add_flag("--each", options.each, "a line a scene");
  app.add_flag("--paper-noise", options.paper_noise, "only the 80x80 eye at the paper's noise, by rule");
  app.add_flag("--family", options.family, "scenes of every kind from 60 to -10 dB");
  app.add_option("--only", options.only, "only cases whose name contains all of these");
  app.footer("Example: bench_lambda_rule --full --only 80x80 tv measured");
  CLI11_PARSE(app, argc, argv);
  if (options.paper_noise) {
    print_paper_noise();
    return 0;
  }
  if (options.family) {
    print_family(options);
    return 0;
  }
  if (!options.tuning) bench::print_evaluation_head();
  for (const bench::Case& c : bench::lambda_cases()) {
    if (!wanted(c, options)) continue;
    const std::vector<bench::Sweep> sweeps = sweep_all(c, options.tuning);
    if (options.tuning) {
      bench::print_tuning(c, sweeps);
    } else {
      bench::print_evaluation(c, sweeps, options.each);
      bench::print_second_passes(c, sweeps);
    }
    static_cast<void>(std::fflush(stdout));
  }
  return 0;
}
