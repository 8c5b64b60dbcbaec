#pragma once

#include <cstdint>

#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// Takes every frame and keeps none: for measuring and for runs that only want the figures.
class NullSink final : public hal::FrameSink {
 public:
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  [[nodiscard]] hal::Result<void> close() override;

  /// Frames since open().
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

 private:
  std::uint64_t frames_ = 0;
};

}  // namespace compueye::firmware
