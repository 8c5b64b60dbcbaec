#include "firmware/pipeline/channel_watch.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace compueye::firmware {

ChannelWatch::ChannelWatch(FrameSolver& inner, const recon::Reconstructor& reconstructor,
                           recon::ChannelDetector detector)
    : inner_(inner),
      reconstructor_(reconstructor),
      detector_(std::move(detector)),
      workspace_(reconstructor.least_residual_bytes()),
      measured_(static_cast<std::size_t>(inner.channels()), 1.0F),
      residuals_(static_cast<std::size_t>(inner.channels())) {}

void ChannelWatch::mask(std::span<float> weights) noexcept {
  std::copy(weights.begin(), weights.end(), measured_.begin());
  const std::span<const std::uint8_t> masked = detector_.masked();
  for (std::size_t m = 0; m < weights.size(); ++m) {
    if (masked[m] != 0) weights[m] = 0.0F;
  }
}

recon::FrameInfo ChannelWatch::solve(std::span<const float> y, std::span<const float> weights,
                                     std::span<float> x) noexcept {
  const recon::FrameInfo info = inner_.solve(y, weights, x);
  if (info.health == recon::Health::invalid) return info;
  reconstructor_.channel_residuals(y, measured_, workspace_.span(), x, residuals_);
  // The last picture was made from what the channel said: going on from it would take many frames to forget.
  if (detector_.look(y, residuals_, measured_)) inner_.forget();
  count_.store(detector_.count(), std::memory_order_relaxed);
  return info;
}

}  // namespace compueye::firmware
