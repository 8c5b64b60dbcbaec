#pragma once

#include <span>

#include "calib/cone_section.hpp"

namespace compueye::calib {

/// An axis-parallel rectangle in the coordinates of a ConeSection (mm from its vertex); x0 < x1, y0 < y1.
struct Cell {
  double x0 = 0.0, x1 = 0.0, y0 = 0.0, y1 = 0.0;
};

/// Exact covered fraction of the cell, 0 to 1. The section is convex, so its vertical chord, clipped to the cell, is
/// integrated between the few x at which it changes form, each piece in closed form: no sampling anywhere. What error
/// there is comes from rounding coordinates: about 1e-15 of the largest one, divided by the size of the cell; 1e-14 for
/// the eyes of the paper. A fraction within `negligible_coverage` of 1 is returned as exactly 1.
[[nodiscard]] double coverage(const ConeSection& section, const Cell& cell) noexcept;

/// A fraction below this is rounding, not light.
inline constexpr double negligible_coverage = 1e-13;

/// What a section does to one row of pixels.
struct RowSpan {
  int begin = 0, end = 0;            ///< pixels it may touch, end exclusive; begin == end: none
  int full_begin = 0, full_end = 0;  ///< those of them wholly inside; full_begin == full_end: none
  Interval at_y0, at_y1;             ///< its chords at the bottom and top edge of the row

  [[nodiscard]] int touched() const noexcept { return end - begin; }
};

/// `x_edges`: the ascending, evenly spaced pixel borders of the row, one more than pixels, mm from the vertex.
[[nodiscard]] RowSpan row_span(const ConeSection& section, std::span<const double> x_edges, double y0,
                               double y1) noexcept;

/// coverage() of one pixel of a row whose span is known.
[[nodiscard]] double coverage(const ConeSection& section, const Cell& cell, const RowSpan& row) noexcept;

}  // namespace compueye::calib
