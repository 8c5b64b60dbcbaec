#include "sim/effects/band_weights.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/picture_change.hpp"

namespace compueye::sim {
namespace {

bool coloured(const Surface& surface) noexcept {
  const std::vector<hal::Image>& bands = surface.bands;
  return bands.size() == 3 && (bands[0].pixels != bands[1].pixels || bands[0].pixels != bands[2].pixels);
}

std::string calls_for(const Circumstances& c) {
  for (const Surface& surface : c.scene.surfaces) {
    const BandWeights w = band_weights(c.board, c.scene, surface);
    if (!coloured(surface) || w == even_bands) continue;
    return "'" + surface.name + "' is coloured, seen by " + figure(w[0]) + " red, " + figure(w[1]) + " green, " +
           figure(w[2]) + " blue";
  }
  return "";
}

// The picture as weighed less the mean of its bands, by picture_change_lsb.
double bound(const Circumstances& c) {
  double sum = 0.0;
  for (const Surface& surface : c.scene.surfaces) {
    if (!coloured(surface)) continue;
    const double light = surface.shines ? 1.0 : c.scene.light.level;
    BandWeights change = band_weights(c.board, c.scene, surface);
    for (std::size_t b = 0; b < 3; ++b) change[b] = light * (change[b] - even_bands[b]);
    sum += picture_change_lsb(c, surface, surface.weighed(change));
  }
  return sum;
}

void apply(const Circumstances& c, Workings& w) {
  for (Surface& surface : w.scene.surfaces) {
    if (coloured(surface)) surface.bands = {surface.weighed(band_weights(c.board, c.scene, surface))};
  }
}

}  // namespace

// One band is rendered whether it is on or not: the bands are weighed pixel by pixel before.
const Effect effect::spectral_response{
    .name = "spectral_response",
    .group = EffectGroup::scene,
    .model = "sum over bands of picture, light's spectrum and response, relative to white's",
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
