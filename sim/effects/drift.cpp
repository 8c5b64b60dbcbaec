#include "sim/effects/drift.hpp"

#include <algorithm>
#include <cmath>

#include "sim/effects/estimates.hpp"
#include "sim/effects/frame_step.hpp"

namespace compueye::sim {
namespace {

constexpr double hour_s = 3600.0;

}  // namespace

double drift_bound(const Circumstances& c, double per_hour) noexcept {
  return margin * std::fabs(per_hour * c.scene.seconds_of_drift() / hour_s) * c.preview.rms;
}

double largest_drift(const Circumstances& c, double per_hour) noexcept {
  return 1.0 + std::max(per_hour * c.scene.seconds_of_drift() / hour_s, 0.0);
}

void add_drift(Workings& w, double per_hour) {
  add_step(w, [per_hour](FrameInWork& frame) noexcept {
    const double light = std::max(1.0 + per_hour * frame.t_s / hour_s, 0.0);
    for (double& level : frame.levels_lsb) level *= light;
  });
}

}  // namespace compueye::sim
