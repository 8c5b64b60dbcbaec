#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace compueye::calib {

/// In what way a row may be off; the kinds are at right angles to each other, in this order.
enum class RowErrorKind {
  gain,    ///< all entries in proportion
  pose,    ///< the cone looks elsewhere
  width,   ///< the cone is wider, or its edge softer
  fields,  ///< everything else: what the fields do not know, and what they hide between their knots
};
inline constexpr std::array<std::string_view, 4> row_error_kinds{"gain", "pose", "width", "fields"};

/// Standard deviations over the norm of the row, by kind, as noise and prior have it: not widened by the patterns held
/// out. Their squares add up to that of the whole row.
struct RowErrors {
  using ByKind = std::array<double, row_error_kinds.size()>;
  ByKind now{};
  ByKind of_twice{};  ///< had there been each pattern twice
};

}  // namespace compueye::calib
