#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/picture_change.hpp"

namespace compueye::sim {
namespace {

/// What a display makes of pixels. Those of one value come in runs, and a power is dear.
class Shown {
 public:
  explicit Shown(const Display& display) noexcept : display_(display), last_shown_(of(last_)) {}
  [[nodiscard]] float operator()(float pixel) noexcept {
    if (pixel != last_) {
      last_ = pixel;
      last_shown_ = of(pixel);
    }
    return last_shown_;
  }

 private:
  [[nodiscard]] float of(float pixel) const noexcept {
    const double light = std::pow(static_cast<double>(pixel), display_.gamma);
    return static_cast<float>(display_.black_level + (1.0 - display_.black_level) * light);
  }

  const Display& display_;
  float last_ = 0.0F, last_shown_;
};

std::string calls_for(const Circumstances& c) {
  const bool shines = std::any_of(c.scene.surfaces.begin(), c.scene.surfaces.end(),
                                  [](const Surface& surface) { return surface.shines; });
  const Display& display = c.scene.display;
  if (!shines || (display.gamma == 1.0 && display.black_level == 0.0)) return "";
  return "a display of gamma " + figure(display.gamma) + " and black level " + figure(display.black_level);
}

// By picture_change_lsb, of the band that changes most.
double bound(const Circumstances& c) {
  Shown shown(c.scene.display);
  double sum = 0.0;
  for (const Surface& surface : c.scene.surfaces) {
    if (!surface.shines) continue;
    double most = 0.0;
    for (hal::Image change : surface.bands) {
      for (float& pixel : change.pixels) pixel = shown(pixel) - pixel;
      most = std::max(most, picture_change_lsb(c, surface, change));
    }
    sum += most;
  }
  return sum;
}

void apply(const Circumstances& c, Workings& w) {
  Shown shown(c.scene.display);
  for (Surface& surface : w.scene.surfaces) {
    if (!surface.shines) continue;
    for (hal::Image& band : surface.bands) {
      for (float& pixel : band.pixels) pixel = shown(pixel);
    }
  }
}

}  // namespace

const Effect effect::display_response{
    .name = "display_response",
    .group = EffectGroup::scene,
    .model = "shown = black level + (1 - black level) picture^gamma, on what shines",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost =
        [](const Circumstances&) {
          return EffectCost{1e-3, 0.0};
        },
    .apply = apply,
};

}  // namespace compueye::sim
