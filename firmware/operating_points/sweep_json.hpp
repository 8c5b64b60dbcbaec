#pragma once

#include <string>

#include "firmware/app/report/json_report.hpp"
#include "firmware/operating_points/measured_points.hpp"

namespace compueye::firmware {

/// Every figure of a sweep: what --json prints and what is stored beside the board.
[[nodiscard]] Json sweep_json(const Sweep& sweep);

/// The same back; `place` is what errors name. Error bad_format: a member that is missing, of another type, or has a
/// name that this program does not know.
[[nodiscard]] hal::Result<Sweep> sweep_from(const Json& json, const std::string& place);

}  // namespace compueye::firmware
