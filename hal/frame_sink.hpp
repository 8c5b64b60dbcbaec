#pragma once

#include <cstdint>
#include <span>

#include "hal/result.hpp"

namespace compueye::hal {

struct FrameFormat {
  int rows = 0;
  int cols = 0;
};

/// A reconstructed picture on its way out. Linear intensity, 0..1 of white (values outside are possible without a
/// box constraint), row 0 on top. The pixels belong to the caller and are valid during write() only.
struct Frame {
  std::span<const float> pixels;
  FrameFormat format;
  std::uint64_t frame = 0;
  std::int64_t t_ns = 0;
};

/// Where pictures go. Called by one thread: open, write..., close.
class FrameSink {
 public:
  FrameSink() = default;
  FrameSink(const FrameSink&) = delete;
  FrameSink& operator=(const FrameSink&) = delete;
  virtual ~FrameSink() = default;

  [[nodiscard]] virtual Result<void> open(FrameFormat format) = 0;
  [[nodiscard]] virtual Result<void> write(const Frame& frame) = 0;
  /// Finishes what was begun; after it every file of this sink is whole. Idempotent.
  [[nodiscard]] virtual Result<void> close() = 0;
};

}  // namespace compueye::hal
