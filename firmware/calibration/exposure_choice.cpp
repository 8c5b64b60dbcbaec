#include "firmware/calibration/exposure_choice.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "calib/session/frame_time.hpp"
#include "firmware/calibration/watched_eye.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::Result;

constexpr double wanted_share = 0.8;  ///< of where saturation begins

/// Frames of white that has settled, added up, by ommatidium.
Result<std::vector<double>> white_sums(const calib::SessionPlan& plan, int frames, hal::SampleSource& source,
                                       hal::Illuminator& light, hal::Clock& clock, const std::function<bool()>& go_on) {
  WatchedEye eye(source, clock);
  const hal::IlluminatorDescription& display = light.describe();
  const std::vector<float> white(static_cast<std::size_t>(display.rows) * static_cast<std::size_t>(display.cols), 1.0F);
  const auto settle_ns = static_cast<std::int64_t>(plan.settle_ms * 1e6);
  calib::FrameTime time;
  std::int64_t settled_ns = TRY(light.show(white)) + settle_ns;
  std::vector<double> sums;
  for (int taken = 0; taken < frames;) {
    const hal::SampleBlock block = TRY(eye.next(go_on));
    TRY(light.attend());
    if (!go_on()) return hal::fail(hal::ErrorCode::interrupted, "calibrate", "was stopped");
    if (eye.was_lost()) {  // and the lamps of its device with it
      settled_ns = TRY(light.show(white)) + settle_ns;
      taken = 0;
      sums.clear();
    }
    if (time.begun_ns(block.t_ns, block.flags.time_ok, clock.now_ns()) < settled_ns) continue;
    ++taken;
    sums.resize(block.codes.size());
    for (std::size_t m = 0; m < sums.size(); ++m) sums[m] += block.valid[m] != 0 ? block.codes[m] : 0.0;
  }
  return sums;
}

/// The code that the brightest of those channels have that may not be saturated.
Result<double> white_level(const calib::SessionPlan& plan, hal::SampleSource& source, hal::Illuminator& light,
                           hal::Clock& clock, const std::function<bool()>& go_on) {
  constexpr int frames = 4;
  std::vector<double> sums = TRY(white_sums(plan, frames, source, light, clock, go_on));
  // As many as the plan allows are left out.
  const auto left_out = static_cast<std::size_t>(plan.saturated_channels * static_cast<double>(sums.size()));
  const auto at = std::min(left_out, sums.size() - 1);
  std::nth_element(sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(at), sums.end(), std::greater<>());
  return sums[at] / frames;
}

}  // namespace

Result<void> ExposureControl::change(std::int64_t ns) {
  if (ns == now_ns) return {};
  TRY(set(ns));
  now_ns = ns;
  return {};
}

Result<void> choose_exposure(ExposureControl& exposure, const calib::SessionPlan& plan, hal::SampleSource& eye,
                             hal::Illuminator& light, hal::Clock& clock, const std::function<bool()>& go_on) {
  const double end = calib::saturated_code(plan, eye.describe().bits);
  bool shortened = false;
  for (;;) {
    TRY(eye.start());
    const auto level = white_level(plan, eye, light, clock, go_on);
    eye.stop();
    if (!level) return tl::unexpected(level.error());
    if (*level < end) {
      // Halves overshoot by up to a half of the range.
      const double longer = std::clamp(wanted_share * end / std::max(*level, 1.0), 1.0, 2.0 * wanted_share);
      return shortened ? exposure.change(static_cast<std::int64_t>(static_cast<double>(exposure.now_ns) * longer))
                       : Result<void>();
    }
    if (exposure.now_ns <= exposure.least_ns) return {};
    shortened = true;
    TRY(exposure.change(std::max(exposure.now_ns / 2, exposure.least_ns)));
  }
}

}  // namespace compueye::firmware
