#pragma once

#include <string_view>

namespace compueye::calib {

/// schema.sql, compiled in. Ends with a zero.
[[nodiscard]] std::string_view schema_text() noexcept;

}  // namespace compueye::calib
