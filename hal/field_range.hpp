#pragma once

#include <string_view>

#include "hal/result.hpp"

namespace compueye::hal {

/// out_of_range that names `field`, its value and what was `expected`, unless `ok`.
[[nodiscard]] Result<void> expect(bool ok, std::string_view field, double value, std::string_view expected);
/// The same for a value of lo to hi; NaN is outside.
[[nodiscard]] Result<void> expect_within(std::string_view field, double value, double lo, double hi);

}  // namespace compueye::hal
