#include "studies/accuracy_and_time/plot_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace compueye::firmware {
namespace {

struct Ranked {
  PlotCurve curve;
  std::size_t efficient = 0;
  double distance = std::numeric_limits<double>::infinity();  ///< least, in decades of time and NMSE together
};

double nmse_of(const Sweep& sweep, std::size_t i, std::size_t level) {
  return sweep.points[i].levels[level].quality.mean.nmse;
}

/// How far a point is from the nearest efficient one that outdoes it.
double distance_of(const Sweep& sweep, std::size_t i, const std::vector<std::size_t>& front, std::size_t level) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t f : front) {
    const double time = std::log10(sweep.points[i].median_ms / sweep.points[f].median_ms);
    const double error = std::log10(nmse_of(sweep, i, level) / nmse_of(sweep, f, level));
    const double distance = std::hypot(time, error);
    if (distance < least) least = distance;
  }
  return least;
}

}  // namespace

std::vector<PlotCurve> plot_curves(const Sweep& sweep, std::size_t level) {
  const std::vector<std::size_t> front = efficient_points(sweep, level);
  std::vector<Ranked> ranked;
  std::vector<Curve> kinds;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const Curve& kind = sweep.points[i].curve;
    const auto at = static_cast<std::size_t>(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
    if (at == kinds.size()) {
      kinds.push_back(kind);
      ranked.push_back({{title(kind), {}, false}});
    }
    ranked[at].curve.points.push_back(i);
    if (std::find(front.begin(), front.end(), i) != front.end()) ++ranked[at].efficient;
    ranked[at].distance = std::min(ranked[at].distance, distance_of(sweep, i, front, level));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    return a.efficient != b.efficient ? a.efficient > b.efficient : a.distance < b.distance;
  });
  std::vector<PlotCurve> curves;
  for (Ranked& one : ranked) {
    one.curve.named = curves.size() < most_named_curves;
    curves.push_back(std::move(one.curve));
  }
  return curves;
}

}  // namespace compueye::firmware
