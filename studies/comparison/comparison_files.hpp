#pragma once

#include <string>

#include "hal/result.hpp"
#include "studies/comparison/comparison.hpp"

namespace compueye::firmware {

/// A header line and a line a contender, the conventional eye first; RFC 4180.
[[nodiscard]] std::string comparison_csv(const Comparison& comparison);

/// Scene, conventional eye and every contender's picture with its figures as a PNG, a row of panels a basis, the best
/// marked. Errors: those of write_contact_sheet().
[[nodiscard]] hal::Result<void> write_comparison_sheet(const std::string& path, const Comparison& comparison);

}  // namespace compueye::firmware
