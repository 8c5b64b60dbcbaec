#pragma once

#include <cstdint>
#include <optional>

#include "firmware/pipeline/block_queue.hpp"
#include "firmware/pipeline/frame_observer.hpp"
#include "firmware/pipeline/frame_slots.hpp"
#include "firmware/pipeline/run_control.hpp"
#include "firmware/pipeline/settings.hpp"
#include "firmware/pipeline/stage_beat.hpp"
#include "firmware/pipeline/time_histogram.hpp"
#include "hal/accounting.hpp"
#include "hal/clock.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// Hands pictures to the sink, in order, and counts the frames that a run is asked for.
class PublishStage {
 public:
  /// `observer` may be null.
  PublishStage(const PipelineSettings& settings, hal::FrameSink& sink, hal::FrameFormat format, hal::Clock& clock,
               FrameObserver* observer, RunControl& control, BlockQueue<PictureSlot>& in, StageBeat& beat) noexcept
      : settings_(settings),
        sink_(sink),
        format_(format),
        clock_(clock),
        observer_(observer),
        control_(control),
        in_(in),
        beat_(beat) {}

  void run() noexcept;

  [[nodiscard]] const hal::FrameAccount& account() const noexcept { return account_; }
  [[nodiscard]] TimeStatistics write_times() const noexcept { return write_times_.statistics(); }
  [[nodiscard]] TimeStatistics ages() const noexcept { return ages_.statistics(); }
  [[nodiscard]] std::uint64_t deadline_misses() const noexcept { return deadline_misses_; }
  [[nodiscard]] const std::optional<hal::Error>& sink_error() const noexcept { return sink_error_; }
  [[nodiscard]] const std::optional<recon::FrameInfo>& last() const noexcept { return last_; }
  [[nodiscard]] std::uint64_t last_frame() const noexcept { return last_frame_; }

 private:
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) noexcept;
  void take(const PictureSlot& picture) noexcept;
  void delivered(const PictureSlot& picture, const hal::Frame& frame, std::int64_t age_ns) noexcept;

  const PipelineSettings& settings_;
  hal::FrameSink& sink_;
  hal::FrameFormat format_;
  hal::Clock& clock_;
  FrameObserver* observer_;
  RunControl& control_;
  BlockQueue<PictureSlot>& in_;
  StageBeat& beat_;

  hal::FrameAccount account_;
  TimeHistogram write_times_;
  TimeHistogram ages_;
  std::uint64_t deadline_misses_ = 0;
  std::optional<hal::Error> sink_error_;
  std::optional<recon::FrameInfo> last_;
  std::uint64_t last_frame_ = 0;
};

}  // namespace compueye::firmware
