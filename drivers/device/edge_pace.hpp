#pragma once

#include <cstdint>
#include <optional>

#include "hal/signal_lines.hpp"

namespace compueye::device {

/// Which frame an edge of data-ready belongs to, when edges are lost on the wire, lost by the kernel, doubled or come
/// in storms.
///
/// Converters keep the pace of a crystal, so time says how many frames have passed: edges are held against a grid of
/// their period, which follows them slowly (an eighth of what one is off; the period a sixty-fourth, and by at most 1 %
/// of the stated one). An edge less than half a period behind the last frame is none of a frame. Where the kernel
/// counts edges, its count stands for a time that cannot tell: beyond 1000 periods, where crystals drift by more than
/// half of one. An edge may be late by less than half a period.
class EdgePace {
 public:
  /// What an edge has told.
  struct Seen {
    bool frame = false;           ///< it is of a frame; otherwise of nothing
    bool unclear = false;         ///< of a frame that may have been complete at another time
    std::uint64_t late = 0;       ///< frames before it whose edges the kernel has seen and nobody has taken
    std::uint64_t unsaid = 0;     ///< frames before it that had no edge
    std::uint64_t spurious = 0;   ///< edges of no frame, this one included
    std::uint64_t estimated = 0;  ///< of late + unsaid, those that only time tells and may be wrong
  };

  /// A new stream, of a stated period.
  void begin(std::int64_t period_ns) noexcept;
  [[nodiscard]] Seen saw(const hal::Edge& edge) noexcept;
  /// Frames complete before `t_ns` that had no edge so far, by time alone.
  [[nodiscard]] std::uint64_t unseen(std::int64_t t_ns) const noexcept;
  /// When the frame behind the last one is complete; before the first one, nothing.
  [[nodiscard]] std::optional<std::int64_t> next_ns() const noexcept;

 private:
  double stated_ns_ = 1.0, period_ns_ = 1.0;
  double grid_ns_ = 0.0;  // when the last frame was complete
  bool begun_ = false;
  std::optional<std::uint64_t> number_;
  std::uint64_t spurious_ = 0;  // since the last frame
};

}  // namespace compueye::device
