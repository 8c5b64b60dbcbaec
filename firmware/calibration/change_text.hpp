#pragma once

#include <string>
#include <vector>

#include "calib/check/eye_change.hpp"

namespace compueye::firmware {

/// Of all three axes together.
[[nodiscard]] double turn_deg(const calib::EyeChange& change);

/// "17 by -5.1 %, 20 by +3.0 %"; of many the first eight.
[[nodiscard]] std::string list_of(const std::vector<calib::ChangedChannel>& channels);

/// What changed, and what to do about each. Empty: nothing did.
[[nodiscard]] std::string change_text(const calib::EyeChange& change);

}  // namespace compueye::firmware
