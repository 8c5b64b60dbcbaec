#include "sim/effects/band_weights.hpp"

namespace compueye::sim {

BandWeights band_weights(const EyeToSimulate& board, const Scene& scene, const Surface& surface) noexcept {
  BandWeights w{};
  double sum = 0.0;
  for (std::size_t b = 0; b < 3; ++b) {
    w[b] = board.detector.spectral_response[b] * (surface.shines ? 1.0 : scene.light.spectrum[b]);
    sum += w[b];
  }
  for (double& each : w) each = sum > 0.0 ? each / sum : 0.0;
  return w;
}

}  // namespace compueye::sim
