#include "calib/session/capture_builder.hpp"

#include <algorithm>
#include <string>

namespace compueye::calib {

std::string_view name(Rejection reason) noexcept {
  switch (reason) {
    case Rejection::gap:
      return "frames lost";
    case Rejection::overrun:
      return "overrun";
    case Rejection::saturated:
      return "saturated";
    case Rejection::configuration:
      return "other configuration";
    case Rejection::recovered:
      return "eye or stream lost";
  }
  return "";
}

CaptureBuilder::CaptureBuilder(int channels, std::uint32_t configuration, std::int32_t saturated_code,
                               int most_saturated)
    : channels_(channels),
      configuration_(configuration),
      saturated_code_(saturated_code),
      most_saturated_(most_saturated) {}

void CaptureBuilder::begin(const Wanted& wanted, bool at_any_level) {
  const auto channels = static_cast<std::size_t>(channels_);
  capture_ = {};
  capture_.stage = std::string(name(wanted.stage));
  capture_.family = std::string(wanted.family);
  capture_.seed = wanted.seed;
  capture_.pattern = wanted.index;
  capture_.frames = wanted.frames;
  capture_.codes.assign(channels, 0);
  capture_.valid.assign(channels, 1);
  wanted_frames_ = wanted.frames;
  taken_ = 0;
  at_any_level_ = at_any_level;
}

void CaptureBuilder::reject(Rejection reason) {
  ++rejected_[static_cast<std::size_t>(reason)];
  last_ = reason;
  ++capture_.repeat;
  taken_ = 0;
  std::fill(capture_.codes.begin(), capture_.codes.end(), 0);
  std::fill(capture_.valid.begin(), capture_.valid.end(), std::uint8_t{1});
  capture_.flags = {};
}

bool CaptureBuilder::believed(const hal::SampleBlock& block) {
  if (block.config_id != configuration_) {
    reject(Rejection::configuration);
    return false;
  }
  if (taken_ > 0 && block.frame != next_frame_) {
    reject(Rejection::gap);
    // The frame after a gap is as good as any: it is the first of the next try.
  } else if (taken_ > 0 && block.flags.overrun) {
    reject(Rejection::overrun);
  }
  int saturated = 0;
  for (std::size_t c = 0; c < block.codes.size(); ++c) {
    saturated += block.valid[c] != 0 && block.codes[c] >= saturated_code_ ? 1 : 0;
  }
  if (at_any_level_ || saturated <= most_saturated_) return true;
  reject(Rejection::saturated);
  return false;
}

bool CaptureBuilder::add(const hal::SampleBlock& block) {
  if (!believed(block)) return false;
  if (taken_ == 0) capture_.device_ns = block.t_ns;
  next_frame_ = block.frame + 1;
  for (std::size_t c = 0; c < capture_.codes.size(); ++c) {
    capture_.codes[c] += block.codes[c];
    capture_.valid[c] = static_cast<std::uint8_t>(capture_.valid[c] != 0 && block.valid[c] != 0);
  }
  capture_.flags.overrun = capture_.flags.overrun || block.flags.overrun;
  capture_.flags.saturated = capture_.flags.saturated || block.flags.saturated;
  capture_.flags.dark = capture_.flags.dark || block.flags.dark;
  capture_.flags.time_ok = (taken_ == 0 || capture_.flags.time_ok) && block.flags.time_ok;
  return ++taken_ == wanted_frames_;
}

}  // namespace compueye::calib
