#include "firmware/pipeline/fit_watch.hpp"

namespace compueye::firmware {

void FitWatch::published(const PublishedFrame& frame) noexcept {
  constexpr std::uint64_t every = 32;
  const bool power_of_two = (frame.delivered & (frame.delivered - 1)) == 0;
  if (power_of_two || frame.delivered % every == 0) {
    const recon::ResponseFit fit = fitter_.fit(frame.info, frame.y, frame.weights, frame.frame.pixels);
    ++summary_.frames;
    if (fit.misfit()) ++summary_.misfits;
    summary_.last = fit;
    if (fit.least >= summary_.worst.least) summary_.worst = fit;
    misfit_.store(fit.misfit() ? fit.residual : 0.0, std::memory_order_relaxed);
  }
  next_.published(frame);
}

}  // namespace compueye::firmware
