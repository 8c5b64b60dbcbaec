#pragma once

#include <cstdint>
#include <optional>

#include "firmware/pipeline/block_queue.hpp"
#include "firmware/pipeline/correction.hpp"
#include "firmware/pipeline/frame_slots.hpp"
#include "firmware/pipeline/run_control.hpp"
#include "firmware/pipeline/settings.hpp"
#include "firmware/pipeline/stage_beat.hpp"
#include "firmware/pipeline/time_histogram.hpp"
#include "hal/accounting.hpp"
#include "hal/clock.hpp"

namespace compueye::firmware {

/// Turns codes into samples and decides whether a frame is worth reconstructing. A frame number that does not rise is
/// `corrupt`: an old frame is never shown as a new one, whatever the source does.
class CorrectStage {
 public:
  CorrectStage(const PipelineSettings& settings, Correction& correction, hal::Clock& clock, RunControl& control,
               BlockQueue<RawSlot>& in, BlockQueue<CorrectedSlot>& out, StageBeat& beat) noexcept
      : settings_(settings),
        correction_(correction),
        clock_(clock),
        control_(control),
        in_(in),
        out_(out),
        beat_(beat) {}

  void run() noexcept;

  // After the thread was joined:
  [[nodiscard]] hal::FrameAccount account() const noexcept;
  [[nodiscard]] TimeStatistics times() const noexcept { return times_.statistics(); }
  [[nodiscard]] std::uint64_t saturated_frames() const noexcept { return saturated_frames_; }
  [[nodiscard]] std::uint64_t config_mismatches() const noexcept { return config_mismatches_; }
  [[nodiscard]] int masked_min() const noexcept { return masked_min_; }
  [[nodiscard]] int masked_max() const noexcept { return masked_max_; }

 private:
  /// False when the device has left its configuration for good.
  [[nodiscard]] bool take(const RawSlot& raw, CorrectedSlot& corrected) noexcept;
  void note_masked(const CorrectionReport& report) noexcept;
  [[nodiscard]] bool configuration_is_lost(const CorrectionReport& report, std::uint32_t config_id) noexcept;

  const PipelineSettings& settings_;
  Correction& correction_;
  hal::Clock& clock_;
  RunControl& control_;
  BlockQueue<RawSlot>& in_;
  BlockQueue<CorrectedSlot>& out_;
  StageBeat& beat_;

  hal::FrameAccount own_;
  std::uint64_t pushed_ = 0;
  std::optional<std::uint64_t> last_frame_;
  TimeHistogram times_;
  std::uint64_t saturated_frames_ = 0;
  std::uint64_t config_mismatches_ = 0;
  std::uint64_t mismatches_in_a_row_ = 0;
  bool masked_known_ = false;
  int masked_min_ = 0;
  int masked_max_ = 0;
};

}  // namespace compueye::firmware
