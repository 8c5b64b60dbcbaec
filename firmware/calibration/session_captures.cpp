#include "firmware/calibration/session_captures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calib/estimate/linearity.hpp"
#include "calib/session/capture_schedule.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::Capture;
using calib::Stage;
using hal::Result;

Result<Stage> stage_of(const Capture& capture, const std::string& file) {
  for (const Stage stage : calib::all_stages) {
    if (name(stage) == capture.stage) return stage;
  }
  return hal::fail(hal::ErrorCode::bad_format, file,
                   "has a capture of stage '" + capture.stage + "', which this program does not know");
}

/// Means over the frames; NaN where a channel's code means nothing.
void append_means(const Capture& capture, std::vector<double>& codes) {
  for (std::size_t c = 0; c < capture.codes.size(); ++c) {
    const bool valid = capture.valid.empty() || capture.valid[c] != 0;
    codes.push_back(valid ? static_cast<double>(capture.codes[c]) / capture.frames
                          : std::numeric_limits<double>::quiet_NaN());
  }
}

/// Of frames x channels.
std::vector<double> means_of(const std::vector<std::int32_t>& codes, std::size_t channels) {
  std::vector<double> means(channels, 0.0);
  const std::size_t frames = codes.size() / channels;
  for (std::size_t k = 0; k < frames * channels; ++k) {
    means[k % channels] += static_cast<double>(codes[k]) / static_cast<double>(frames);
  }
  return means;
}

/// The device's time in seconds, ascending.
class CaptureTime {
 public:
  [[nodiscard]] double of(const Capture& capture) noexcept {
    const double device_s = static_cast<double>(capture.device_ns) * 1e-9;
    constexpr double apart_s = 3600.0, least_s = 1e-9;
    if (device_s + shift_s_ <= last_s_) shift_s_ = last_s_ + (device_s < before_s_ ? apart_s : least_s) - device_s;
    before_s_ = device_s;
    return last_s_ = device_s + shift_s_;
  }

 private:
  double shift_s_ = 0.0, last_s_ = -1.0, before_s_ = -1.0;
};

class Sorter {
 public:
  Sorter(SessionCaptures& into, int rows, int cols, double period_s) : into_(into), rows_(rows), cols_(cols) {
    constexpr std::array lights{0.0, 0.05, 1.0};  // of a black picture the display's own, which is not known yet
    for (const double light : lights) into_.series.push_back({light, period_s, {}});
  }

  Result<void> add(Stage stage, const Capture& capture) {
    const double time = time_.of(capture);
    if (capture.exposure_s) {
      for (calib::LightSeries& series : into_.series) series.exposure_s = *capture.exposure_s;
    }
    calib::Captures& c = into_.captures;
    switch (stage) {
      case Stage::dark:
        return add_frame(0, capture);
      case Stage::black:
        return add_frame(1, capture);
      case Stage::flat:
        return add_frame(2, capture);
      case Stage::reference:
        return add_between(c.references, capture, time);
      case Stage::interleaved_dark:
        return add_between(c.darks, capture, time);
      case Stage::pattern:
      case Stage::held_out:
        break;
      case Stage::ramp:
        append_means(capture, splits_.emplace_back().part);
        return {};
      case Stage::ramp_white:
        if (!splits_.empty()) append_means(capture, splits_.back().whole);
        return {};
      case Stage::ramp_rest:
        if (!splits_.empty()) append_means(capture, splits_.back().rest);
        return {};
      case Stage::resumed:
        return {};
    }
    const calib::Wanted shown{stage, capture.family, capture.seed, capture.pattern, capture.frames};
    const hal::Image picture = TRY(calib::picture_of(shown, rows_, cols_));
    c.patterns.insert(c.patterns.end(), picture.pixels.begin(), picture.pixels.end());
    append_means(capture, c.codes);
    c.frames.push_back(capture.frames);
    c.time.push_back(time);
    c.held_out.push_back(stage == Stage::held_out ? 1 : 0);
    return {};
  }

  [[nodiscard]] const std::vector<calib::SplitWhite>& splits() const noexcept { return splits_; }

 private:
  Result<void> add_frame(std::size_t series, const Capture& capture) {
    auto& codes = into_.series[series].codes;
    codes.insert(codes.end(), capture.codes.begin(), capture.codes.end());
    return {};
  }
  static Result<void> add_between(calib::Interleaved& all, const Capture& capture, double time) {
    all.time.push_back(time);
    all.frames = capture.frames;
    append_means(capture, all.codes);
    return {};
  }

  SessionCaptures& into_;
  int rows_, cols_;
  CaptureTime time_;
  std::vector<calib::SplitWhite> splits_;
};

}  // namespace

Result<SessionCaptures> session_captures(const calib::EyeFile& file, const calib::StoredSession& session,
                                         double exposure_s) {
  SessionCaptures all;
  Sorter sorter(all, file.eye().plane.rows, file.eye().plane.cols, exposure_s);
  auto reader = TRY(file.captures(session.id));
  while (const auto capture = TRY(reader.next())) TRY(sorter.add(TRY(stage_of(*capture, file.path())), *capture));
  const auto channels = static_cast<std::size_t>(file.eye().geometry.ommatidia());
  all.captures.dark_lsb = means_of(all.series[0].codes, channels);
  all.captures.linearity = calib::linearity_tables(sorter.splits(), means_of(all.series[1].codes, channels),
                                                   std::ldexp(1.0, session.begun.bits) - 1.0);
  return all;
}

calib::CodeNoise code_noise(const calib::SensorNoise& sensor, double unit_lsb, double saturated_lsb) {
  calib::CodeNoise noise;
  noise.unit_lsb = unit_lsb;
  noise.saturated_lsb = saturated_lsb;
  if (sensor.median.gain_lsb_per_e) noise.electrons_per_lsb = 1.0 / *sensor.median.gain_lsb_per_e;
  // The estimator adds rounding itself; a hundredth of an LSB is no noise at all.
  constexpr double rounding = 1.0 / 12.0, least = 1e-2;
  const double dark = sensor.median.dark_noise_lsb.value_or(0.0);
  noise.read_noise_lsb = std::sqrt(std::max(dark * dark - rounding, least * least));
  return noise;
}

}  // namespace compueye::firmware
