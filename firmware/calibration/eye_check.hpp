#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calib/check/eye_change.hpp"
#include "calib/estimate/captures.hpp"
#include "calib/estimate/light_samples.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "calib/session/capture_schedule.hpp"
#include "calib/session/session_plan.hpp"
#include "firmware/calibration/around.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Whether an eye still sees as it did when it was calibrated: four frames under light and four without, against what
/// the session itself had seen of the same pictures. No model of the eye is asked but for what a turn would change.
class EyeCheck {
 public:
  /// By the newest estimate of the file at a distance that was made from a session. `exposure_s` and `unit_lsb` as in
  /// EstimateRequest. Errors: those of the file and of session_captures(); not_found (no such estimate; the session has
  /// no references or no patterns).
  [[nodiscard]] static hal::Result<EyeCheck> create(const calib::EyeFile& file, double distance_mm, double exposure_s,
                                                    double unit_lsb);

  /// The session's, by which the light is found good enough.
  [[nodiscard]] const calib::SessionPlan& plan() const noexcept { return plan_; }
  [[nodiscard]] std::int64_t session() const noexcept { return session_; }
  [[nodiscard]] std::int64_t estimate() const noexcept { return estimate_; }
  [[nodiscard]] int bits() const noexcept { return bits_; }  ///< of the session's codes
  /// What the session was exposed for, where that could be set.
  [[nodiscard]] std::optional<std::int64_t> exposure_ns() const noexcept { return exposure_ns_; }
  /// What is to be taken: no light, white, and the three patterns that tell most of a turn; in a scene no light once
  /// more, so that it is known whether the scene stood still.
  [[nodiscard]] std::vector<calib::Wanted> schedule(Around around = Around::dark) const;
  /// Captures of that schedule, in its order. Errors: mismatch (others, or of other channels), those of
  /// calib::eye_change(), and out_of_range (at `scene`: its light changed meanwhile).
  [[nodiscard]] hal::Result<calib::EyeChange> judge(std::span<const calib::Capture> captures,
                                                    Around around = Around::dark) const;

 private:
  [[nodiscard]] hal::Result<void> check_captures(std::span<const calib::Capture> captures, Around around) const;
  [[nodiscard]] calib::LightSamples seen(std::span<const calib::Capture> captures) const;
  [[nodiscard]] hal::Result<void> check_still(std::span<const calib::Capture> captures,
                                              const calib::Capture& closing) const;

  calib::SessionPlan plan_;
  std::int64_t session_ = 0, estimate_ = 0;
  int bits_ = 0;
  std::optional<std::int64_t> exposure_ns_;
  std::vector<calib::Wanted> schedule_;
  calib::CheckSamples samples_;  // all but what is seen now
  calib::CodeNoise noise_;
  std::vector<calib::LinearityTable> linearity_;
  double dark_frames_ = 1.0;       // averaged in the session's dark levels
  std::vector<double> own_noise_;  // M: variance of a channel's read noise over the median one's, >= 1
};

}  // namespace compueye::firmware
