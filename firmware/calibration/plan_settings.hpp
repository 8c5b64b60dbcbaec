#pragma once

#include <span>
#include <string>

#include "calib/session/session_plan.hpp"
#include "firmware/eye/settings/setting.hpp"

namespace compueye::firmware {

[[nodiscard]] std::span<const Section> plan_sections();
/// Every key of a plan file.
[[nodiscard]] std::span<const SettingOf<calib::SessionPlan>> plan_settings();

}  // namespace compueye::firmware
