#pragma once

#include <vector>

namespace compueye::calib {

/// NaN counts for nothing; 0 of none at all.
[[nodiscard]] double median(std::vector<double> values) noexcept;

}  // namespace compueye::calib
