#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

/// Widest strip over which a display's pixel runs into its neighbour.
double strip_mm(const Circumstances& c) noexcept {
  double widest = 0.0;
  for (const Surface& surface : c.scene.surfaces) {
    if (!surface.shines) continue;
    const double pixel =
        std::max(surface.width_mm / surface.picture().cols, surface.height_mm / surface.picture().rows);
    widest = std::max(widest, c.scene.display.pixel_blur * pixel);
  }
  return widest;
}

// A picture blurred over a strip b is the mean of pictures moved by up to b / 2 either way: to second order a level
// changes by half the variance b^2 / 12 times its second derivative, for both directions together at most twice that of
// the larger. At the picture's border, which has no neighbour to run into, up to three times that (seen of a white
// sheet). Where a strip is no longer narrow, by less than the gradient's b / 2.
double bound(const Circumstances& c) {
  const double strip = strip_mm(c);
  const double curved = 3.0 * strip * strip / 12.0 * c.preview.laplacian_rms;
  return margin * std::min(curved, strip * steepness_lsb_per_mm(c));
}

}  // namespace

const Effect effect::pixel_blur{
    .name = "pixel_blur",
    .group = EffectGroup::scene,
    .model = "a display's pixels run into each other over a share of their width",
    .error = ErrorKind::row_shape,
    .calls_for = [](const Circumstances& c) -> std::string {
      const double strip = strip_mm(c);
      return strip > 0.0 ? "a display's pixels run into each other over " + figure(strip) + " mm" : "";
    },
    .bound = bound,
    .cost = [](const Circumstances& c) { return render_once_cost(c, 1.0); },
    .apply = [](const Circumstances& c, Workings& w) { w.render.pixel_edge_blur = c.scene.display.pixel_blur; },
};

}  // namespace compueye::sim
