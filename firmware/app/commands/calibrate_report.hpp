#pragma once

#include <string>

#include "calib/eye_file/eye_file.hpp"
#include "calib/session/session_machine.hpp"
#include "firmware/calibration/session_estimate.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What a session and its estimate came to, for people and programs; `eye`: the file as it was named. Errors: those of
/// the file.
[[nodiscard]] hal::Result<Figures> calibration_report(const std::string& eye, const calib::SessionProgress& progress,
                                                      const calib::StoredSession& session, const SessionEstimate& made,
                                                      const calib::EyeFile& file);

/// A sentence on an estimate that no picture should be trusted to; empty: none is needed.
[[nodiscard]] std::string doubt_of(const SessionEstimate& made);

}  // namespace compueye::firmware
