#pragma once

#include <optional>

#include "calib/eye_file/eye_records.hpp"

namespace compueye::firmware {

/// What the median row is known to: the norm of its stated sigmas over that of its entries. Nothing where there are no
/// sigmas.
[[nodiscard]] std::optional<double> median_row_error(const calib::MeasuredResponse& measured);

}  // namespace compueye::firmware
