#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

// No ray of a channel is farther from z than its axis by more than half the acceptance angle, so no level loses a
// larger share than that ray does.
double bound(const Circumstances& c) {
  const hal::EyeGeometry& eye = c.board.eye;
  double squares = 0.0;
  for (std::size_t m = 0; m < c.preview.levels.size(); ++m) {
    const hal::Vec3 axis = eye.axis(static_cast<int>(m) / eye.columns, static_cast<int>(m) % eye.columns);
    const double angle = std::acos(std::clamp(axis.z, -1.0, 1.0)) + eye.acceptance_rad / 2.0;
    const double loss = 1.0 - std::pow(std::max(std::cos(angle), 0.0), c.board.build.vignetting);
    squares += std::pow(loss * c.preview.levels[m], 2);
  }
  return margin * std::sqrt(squares / static_cast<double>(c.preview.levels.size()));
}

}  // namespace

const Effect effect::vignetting{
    .name = "vignetting",
    .group = EffectGroup::optics,
    .model = "light of a ray at angle t from z times cos^n t",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double power = c.board.build.vignetting;
      return power > 0.0 ? "oblique light falls as cos^" + figure(power) : "";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return render_once_cost(c, 0.2); },
    .apply = [](const Circumstances& c, Workings& w) { w.optics.obliquity = c.board.build.vignetting; },
};

}  // namespace compueye::sim
