#pragma once

#include <string>

#include "calib/check/eye_change.hpp"
#include "firmware/calibration/eye_check.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What a check found, for people and programs.
[[nodiscard]] Figures check_report(const std::string& file, const EyeCheck& check, const calib::EyeChange& change);

/// Error mismatch where something changed: what, and what to do about it. The place is the file.
[[nodiscard]] hal::Result<void> check_verdict(const std::string& file, const calib::EyeChange& change);

}  // namespace compueye::firmware
