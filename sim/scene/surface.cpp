#include "sim/scene/surface.hpp"

namespace compueye::sim {
namespace {

template <class Number>
hal::Image sum_of(const Surface& surface, const BandWeights& weights) {
  hal::Image sum = surface.picture();
  const bool alike = surface.bands.size() == 1;
  for (std::size_t n = 0; n < sum.pixels.size(); ++n) {
    Number light{};
    for (std::size_t b = 0; b < weights.size(); ++b) {
      light += static_cast<Number>(weights[b]) * static_cast<Number>(surface.bands[alike ? 0 : b].pixels[n]);
    }
    sum.pixels[n] = static_cast<float>(light);
  }
  return sum;
}

}  // namespace

hal::Image Surface::weighed(const BandWeights& weights) const {
  return sum_of<double>(*this, weights);
}

// In single precision, in which it has always been: samples of coloured scenes keep their bits.
hal::Image Surface::grey() const {
  return bands.size() == 1 ? picture() : sum_of<float>(*this, even_bands);
}

}  // namespace compueye::sim
