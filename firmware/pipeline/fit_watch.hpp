#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/pipeline/frame_observer.hpp"
#include "recon/response_fit.hpp"

namespace compueye::firmware {

/// What was found of how the response fits the frames.
struct FitSummary {
  std::uint64_t frames = 0;   ///< looked at
  std::uint64_t misfits = 0;  ///< of them
  recon::ResponseFit last, worst;
};

/// Looks at some published frames, whether the response fits them, on the publish thread beside the solver; hands every
/// frame on. Frames 1, 2, 4, 8 and so on, and every 32nd.
class FitWatch final : public FrameObserver {
 public:
  /// Both must outlive the watch. `sigma` as for recon::ResponseFitter.
  FitWatch(const recon::Reconstructor& reconstructor, double sigma, FrameObserver& next)
      : fitter_(reconstructor, sigma), next_(next) {}

  void published(const PublishedFrame& frame) noexcept override;

  /// From any thread: how many times what noise explains is the residual of the last frame looked at; 0 when it fits.
  [[nodiscard]] double misfit() const noexcept { return misfit_.load(std::memory_order_relaxed); }
  // After the run:
  [[nodiscard]] const FitSummary& summary() const noexcept { return summary_; }

 private:
  recon::ResponseFitter fitter_;
  FrameObserver& next_;
  FitSummary summary_;
  std::atomic<double> misfit_{0.0};
};

}  // namespace compueye::firmware
