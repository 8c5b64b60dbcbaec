#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

double way_mm(const Circumstances& c) noexcept {
  return speed_mm_per_s(c) * c.board.detector.scan_s();
}

/// Renders so close that less than a quarter of a look is gone between two.
int instants(const Circumstances& c) noexcept {
  return static_cast<int>(std::clamp(1.0 + std::ceil(4.0 * way_mm(c) / look_radius_mm(c)), 2.0, 16.0));
}

}  // namespace

// The last channel sees what has moved by the whole way, the first by nothing: 1 / sqrt 3 of it rms, so the gradient's
// over the whole way is a bound.
const Effect effect::sampling_skew{
    .name = "sampling_skew",
    .group = EffectGroup::timing,
    .model = "each channel at its own time of the scan",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      if (!(way_mm(c) > 0.0) || c.scene.still()) return "";
      return "something moves by " + figure(way_mm(c)) + " mm while the channels are scanned";
    },
    .bound =
        [](const Circumstances& c) {
          return margin * std::min(steepness_lsb_per_mm(c) * way_mm(c), 2.0 * c.preview.rms);
        },
    .cost =
        [](const Circumstances& c) {
          return c.scene.still() ? EffectCost{} : EffectCost{0.0, render_cost(c, instants(c) - 1.0).frame_s};
        },
    .apply =
        [](const Circumstances& c, Workings& w) {
          if (c.scene.still() || !(c.board.detector.scan_s() > 0.0)) return;
          w.exposure.channels_in_turn = true;
          w.exposure.scan_instants = instants(c);
        },
};

}  // namespace compueye::sim
