#pragma once

#include <string>
#include <string_view>

#include "calib/session/session_plan.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A calibration's plan from a TOML file; what it does not state is as SessionPlan has it. Errors: those of reading it,
/// and not_found, bad_format, out_of_range at "file:line", as of board files.
[[nodiscard]] hal::Result<calib::SessionPlan> load_plan(const std::string& file);
[[nodiscard]] hal::Result<calib::SessionPlan> parse_plan(std::string_view text, const std::string& file);

/// Every setting in TOML: the same plan has the same text.
[[nodiscard]] std::string text_of(const calib::SessionPlan& plan);

/// The tables of docs/calibration.md: every section with its keys.
[[nodiscard]] std::string plan_reference();

}  // namespace compueye::firmware
