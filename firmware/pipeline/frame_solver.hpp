#pragma once

#include <span>

#include "hal/frame_sink.hpp"
#include "recon/core/frame/frame_info.hpp"

namespace compueye::firmware {

/// What the pipeline asks of a solver: one virtual call per frame. Called by one thread at a time; whatever memory it
/// works in is its own and was allocated before the first call.
class FrameSolver {
 public:
  FrameSolver() = default;
  FrameSolver(const FrameSolver&) = delete;
  FrameSolver& operator=(const FrameSolver&) = delete;
  virtual ~FrameSolver() = default;

  [[nodiscard]] virtual int channels() const noexcept = 0;  ///< M, blind rows included
  [[nodiscard]] virtual hal::FrameFormat format() const noexcept = 0;

  /// Before solve(): sets to 0 the weights of channels that this solver leaves out by itself.
  virtual void mask(std::span<float> /*weights*/) noexcept {}
  /// The next frame goes on from nothing.
  virtual void forget() noexcept {}

  /// y and weights have M entries (weights 0 or 1; y is 0 where the weight is), x has rows * cols. No allocation, no
  /// lock, no exception. A frame whose health is `invalid` is not published.
  virtual recon::FrameInfo solve(std::span<const float> y, std::span<const float> weights,
                                 std::span<float> x) noexcept = 0;
};

}  // namespace compueye::firmware
