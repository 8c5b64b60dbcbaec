#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/recording/recording_reader.hpp"
#include "firmware/app/report/json_report.hpp"

namespace compueye::firmware {

/// Frames that are missing between two recorded ones.
struct FrameGap {
  std::uint64_t before_frame = 0;  ///< number of the frame that came after the gap
  std::uint64_t frames = 0;
};

/// What a recording holds, gathered while it is read.
class RecordingSummary {
 public:
  static constexpr std::size_t most_listed_gaps = 20;

  void add(const recording::RecordedFrame& frame);

  /// For people: a few lines. `reader` has been read to its end.
  [[nodiscard]] std::string text(const recording::RecordingReader& reader) const;
  /// For machines: every figure.
  [[nodiscard]] Json json(const recording::RecordingReader& reader) const;

 private:
  [[nodiscard]] std::string frames_text(const recording::RecordingReader& reader) const;

  std::uint64_t frames_ = 0;
  std::uint64_t next_frame_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t missing_ = 0;         // in them
  std::vector<FrameGap> first_gaps_;  // most_listed_gaps of them
  std::uint64_t saturated_ = 0, dark_ = 0, overrun_ = 0, untrusted_times_ = 0;
  std::uint64_t invalid_samples_ = 0;
  std::uint64_t configurations_ = 0;  // times that config_id changed, and the first
  std::optional<std::uint32_t> last_config_;
  std::int64_t first_arrival_ns_ = 0, last_arrival_ns_ = 0;
};

}  // namespace compueye::firmware
