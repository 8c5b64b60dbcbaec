#include "recon/response_fit.hpp"

#include <cmath>

namespace compueye::recon {

ResponseFit ResponseFitter::fit(const FrameInfo& info, std::span<const float> y, std::span<const float> weights,
                                std::span<const float> x) const noexcept {
  // What float32 loses of a sample on its way through A and back.
  constexpr double rounding = 1e-6;
  const core::LeastResidual found = reconstructor_.least_residual(y, weights, workspace_.span(), x);
  const double noise = sigma_ * std::sqrt(static_cast<double>(info.channels_used)) + rounding * found.samples;
  if (info.health == Health::invalid || !(noise > 0.0)) return {};
  return {info.residual / noise, found.least / noise};
}

}  // namespace compueye::recon
