#include "firmware/pipeline/correct_stage.hpp"

#include <algorithm>
#include <string>

#include "firmware/pipeline/stage_account.hpp"

namespace compueye::firmware {

void CorrectStage::run() noexcept {
  while (!control_.stop_seen()) {
    // The place to write is taken first: whatever is then popped is as new as it can be.
    CorrectedSlot* const corrected = out_.claim();
    if (corrected == nullptr) break;
    const RawSlot* const raw = in_.pop();
    if (raw == nullptr || !take(*raw, *corrected)) break;
  }
  in_.abort();
  out_.close();
}

bool CorrectStage::take(const RawSlot& raw, CorrectedSlot& corrected) noexcept {
  ++own_.produced;
  const hal::SampleBlock block = raw.view();
  if (last_frame_ && block.frame <= *last_frame_) {
    ++own_.drops(hal::DropReason::corrupt);
    beat_.dropped(clock_.now_ns());
    return true;
  }
  last_frame_ = block.frame;

  const std::int64_t begin_ns = clock_.now_ns();
  beat_.begins(begin_ns);
  const CorrectionReport report = correction_.apply(block, corrected.y, corrected.weights);
  const std::int64_t end_ns = clock_.now_ns();
  beat_.ends(end_ns);
  times_.add(end_ns - begin_ns);

  note_masked(report);
  if (report.saturated > 0) ++saturated_frames_;
  if (!report.usable) {
    ++own_.drops(report.reason);
    // That too few channels see is the scene's doing.
    if (report.reason == hal::DropReason::corrupt) beat_.dropped(end_ns);
    return !configuration_is_lost(report, block.config_id);
  }
  mismatches_in_a_row_ = 0;
  corrected.stamp = raw.stamp;
  if (out_.push()) {
    ++pushed_;
    beat_.handed_on();
  } else {
    ++own_.drops(hal::DropReason::stopped);
  }
  return true;
}

void CorrectStage::note_masked(const CorrectionReport& report) noexcept {
  if (!report.usable && report.reason == hal::DropReason::corrupt) return;
  masked_min_ = masked_known_ ? std::min(masked_min_, report.masked) : report.masked;
  masked_max_ = std::max(masked_max_, report.masked);
  masked_known_ = true;
}

bool CorrectStage::configuration_is_lost(const CorrectionReport& report, std::uint32_t config_id) noexcept {
  if (!report.config_mismatch) {
    mismatches_in_a_row_ = 0;
    return false;
  }
  ++config_mismatches_;
  ++mismatches_in_a_row_;
  if (settings_.config_patience == 0 || mismatches_in_a_row_ < settings_.config_patience) return false;
  control_.end_input({hal::ErrorCode::mismatch, "configuration",
                      "the last " + std::to_string(mismatches_in_a_row_) + " frames were taken with configuration " +
                          std::to_string(config_id) + ", expected " +
                          std::to_string(correction_.config_id().value_or(0)) +
                          ", which the dark frame and gains belong to; reset the device or calibrate this one"});
  return true;
}

hal::FrameAccount CorrectStage::account() const noexcept {
  return with_queue(own_, pushed_, out_);
}

}  // namespace compueye::firmware
