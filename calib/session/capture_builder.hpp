#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "calib/session/capture.hpp"
#include "calib/session/capture_schedule.hpp"
#include "hal/sample_block.hpp"

namespace compueye::calib {

/// Why frames were not taken.
enum class Rejection { gap, overrun, saturated, configuration, recovered };
inline constexpr std::size_t rejections = 5;

[[nodiscard]] std::string_view name(Rejection reason) noexcept;

/// Adds up the frames of one capture, and begins again when one of them cannot be believed.
class CaptureBuilder {
 public:
  /// `configuration`: the session's hal::SampleBlock::config_id. More saturated channels than `most_saturated` spoil a
  /// frame; a channel is saturated from `saturated_code` on.
  CaptureBuilder(int channels, std::uint32_t configuration, std::int32_t saturated_code, int most_saturated);

  /// `at_any_level`: saturated channels spoil nothing.
  void begin(const Wanted& wanted, bool at_any_level = false);
  /// A frame of the light that is wanted. True: the capture is whole.
  [[nodiscard]] bool add(const hal::SampleBlock& block);
  [[nodiscard]] const Capture& capture() const noexcept { return capture_; }
  /// The source lost its device or its stream and has it back: nothing of before counts.
  void recovered() { reject(Rejection::recovered); }

  /// Frames that were not taken, and captures that were begun again for them, since the first.
  [[nodiscard]] std::uint64_t rejected(Rejection reason) const noexcept {
    return rejected_[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] int retakes() const noexcept { return capture_.repeat; }  ///< of this capture
  [[nodiscard]] Rejection last_rejection() const noexcept { return last_; }

 private:
  [[nodiscard]] bool believed(const hal::SampleBlock& block);
  void reject(Rejection reason);

  int channels_;
  std::uint32_t configuration_;
  std::int32_t saturated_code_;
  int most_saturated_;
  Capture capture_;
  int wanted_frames_ = 1, taken_ = 0;
  bool at_any_level_ = false;
  std::uint64_t next_frame_ = 0;
  std::array<std::uint64_t, rejections> rejected_{};
  Rejection last_ = Rejection::gap;
};

}  // namespace compueye::calib
