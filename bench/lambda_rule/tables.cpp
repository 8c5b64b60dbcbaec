#include "bench/lambda_rule/tables.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>

namespace compueye::bench {
namespace {

/// Above this the eye does not see enough of a scene at any lambda, and ratios say little.
constexpr double unseen_above = 0.5;
/// A picture recovered to this is exact for any purpose; ratios to less would compare rounding.
constexpr double least_nmse = 1e-5;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2.0;
}

double ratio(double nmse, double best) {
  return std::max(nmse, least_nmse) / std::max(best, least_nmse);
}

/// "1.05 /  1.2 (12)": median, worst, how many.
std::string summary(const std::vector<double>& ratios) {
  if (ratios.empty()) return fmt::format("{:>18}", "-");
  return fmt::format("{:5.2f} /{:6.2f} ({:3})", median(ratios), *std::max_element(ratios.begin(), ratios.end()),
                     ratios.size());
}

std::vector<double> ratios_of(const std::vector<Sweep>& sweeps, bool seen,
                              const std::function<double(const Sweep&)>& at) {
  std::vector<double> ratios;
  for (const Sweep& sweep : sweeps) {
    if ((sweep.best() <= unseen_above) == seen) ratios.push_back(ratio(at(sweep), sweep.best()));
  }
  return ratios;
}

}  // namespace

void print_tuning(const Case& c, const std::vector<Sweep>& sweeps) {
  fmt::print("{}: tuning scenes, NMSE / best NMSE where that is at most {}: median / worst (scenes)\n", c.name,
             unseen_above);
  for (std::size_t k = 0; k < sweeps.front().multiples.size(); ++k) {
    fmt::print("  {:8.4f} x rule: {}\n", sweeps.front().multiples[k],
               summary(ratios_of(sweeps, true, [k](const Sweep& s) { return s.nmse[k]; })));
  }
}

void print_evaluation_head() {
  fmt::print("NMSE / best NMSE: median / worst (scenes); 'seen' where the best NMSE is at most {}\n", unseen_above);
  fmt::print("{:32} {:>18} {:>18} {:>18} {:>18} {:>18} {:>9}\n", "case", "rule, seen", "without fig2", "by risk, seen",
             "rule, unseen", "by risk, unseen", "best NMSE");
}

void print_second_passes(const Case& c, const std::vector<Sweep>& sweeps) {
  if (c.basis != recon::BasisKind::identity) return;
  for (const double sigma : c.evaluation_sigmas) {
    std::vector<Sweep> here;
    std::copy_if(sweeps.begin(), sweeps.end(), std::back_inserter(here),
                 [sigma](const Sweep& s) { return s.sigma == sigma; });
    const auto over_best = [&here](double Sweep::*nmse) {
      std::vector<double> ratios;
      ratios.reserve(here.size());
      for (const Sweep& s : here) ratios.push_back(ratio(s.*nmse, s.best()));
      return summary(ratios);
    };
    fmt::print("  sigma {:5}, NMSE / best NMSE of one pass: rule {}  debiased {}  reweighted {}\n", sigma,
               over_best(&Sweep::at_rule), over_best(&Sweep::debiased), over_best(&Sweep::reweighted));
  }
}

void print_evaluation(const Case& c, const std::vector<Sweep>& sweeps, bool each) {
  const auto rule = [](const Sweep& s) { return s.at_rule; };
  const auto risk = [](const Sweep& s) { return s.by_risk; };
  std::vector<double> best;
  for (const Sweep& sweep : sweeps) {
    best.push_back(sweep.best());
    if (!each) continue;
    fmt::print(
        "  {:10} seed {} sigma {:5}: best {:.5f} at {:8.4f} x rule; rule {:.5f} ({:.2f}); by risk {:.5f} ({:.2f}) "
        "at {} x\n",
        sweep.scene, sweep.seed, sweep.sigma, sweep.best(), sweep.best_multiple(), sweep.at_rule,
        ratio(sweep.at_rule, sweep.best()), sweep.by_risk, ratio(sweep.by_risk, sweep.best()), sweep.risk_multiple);
  }
  std::vector<Sweep> no_blocks;
  std::copy_if(sweeps.begin(), sweeps.end(), std::back_inserter(no_blocks),
               [](const Sweep& s) { return s.scene != "fig2"; });
  fmt::print("{:32} {} {} {} {} {} {:9.4f}\n", c.name, summary(ratios_of(sweeps, true, rule)),
             summary(ratios_of(no_blocks, true, rule)), summary(ratios_of(sweeps, true, risk)),
             summary(ratios_of(sweeps, false, rule)), summary(ratios_of(sweeps, false, risk)), median(best));
}

}  // namespace compueye::bench
