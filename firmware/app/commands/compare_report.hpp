#pragma once

#include <string>

#include "firmware/app/report/json_report.hpp"
#include "studies/comparison/comparison.hpp"

namespace compueye::firmware {

/// A table with a line a contender, the conventional eye first, and what to read in it.
[[nodiscard]] std::string compare_text(const Comparison& comparison);
[[nodiscard]] Json compare_json(const Comparison& comparison);

}  // namespace compueye::firmware
