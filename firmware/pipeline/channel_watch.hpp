#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/pipeline/frame_solver.hpp"
#include "recon/aligned_workspace.hpp"
#include "recon/channel_detector.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// A solver that finds channels which tell nothing of the picture and leaves them out. Costs one A a frame, on the
/// solver's thread.
class ChannelWatch final : public FrameSolver {
 public:
  /// `inner` and `reconstructor`, whose response the residuals are of, must outlive it.
  ChannelWatch(FrameSolver& inner, const recon::Reconstructor& reconstructor, recon::ChannelDetector detector);

  [[nodiscard]] int channels() const noexcept override { return inner_.channels(); }
  [[nodiscard]] hal::FrameFormat format() const noexcept override { return inner_.format(); }
  void mask(std::span<float> weights) noexcept override;
  recon::FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                         std::span<float> x) noexcept override;
  void forget() noexcept override { inner_.forget(); }

  /// From any thread: channels that are masked now.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_.load(std::memory_order_relaxed); }
  // After the run:
  [[nodiscard]] const recon::ChannelDetector& detector() const noexcept { return detector_; }

 private:
  FrameSolver& inner_;
  const recon::Reconstructor& reconstructor_;
  recon::ChannelDetector detector_;
  recon::AlignedWorkspace workspace_;
  std::vector<float> measured_;  // weights before mask()
  std::vector<float> residuals_;
  std::atomic<std::uint64_t> count_{0};
};

}  // namespace compueye::firmware
