#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "calib/emva1288.hpp"
#include "calib/estimate/estimate.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "firmware/calibration/error_budget.hpp"

namespace compueye::firmware {

/// What a session's captures do not say.
struct EstimateRequest {
  double exposure_s = 0.0;  ///< of a frame
  double unit_lsb = 0.0;    ///< LSB that a fully seen white pixel gives as drawn
  std::string program;      ///< version
  std::int64_t now_unix_s = 0;
  int threads = 1;
  /// What the errors of such rows, from patterns of so many frames each, do to a picture: stored with them. May be
  /// none.
  std::function<hal::Result<std::optional<ErrorBudget>>(const calib::ResponseEstimate&, std::span<const double> frames)>
      budget = {};
};

struct SessionEstimate {
  std::int64_t id = 0;  ///< in the file
  calib::ResponseEstimate rows;
  calib::SensorNoise sensor;
  std::optional<ErrorBudget> budget;
};

/// From the captures of a session that has ended to rows, stored in its file: of the file's eye, at the session's
/// distance, by the session's plan. Errors: those of the file, of session_captures(), sensor_noise() and
/// estimate_response(); interrupted.
[[nodiscard]] hal::Result<SessionEstimate> estimate_session(calib::EyeFile& file, const calib::StoredSession& session,
                                                            const EstimateRequest& request,
                                                            const calib::Progress& progress = {});

}  // namespace compueye::firmware
