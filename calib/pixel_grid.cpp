#include "calib/pixel_grid.hpp"

namespace compueye::calib {
namespace {

// Written so that they mirror bit by bit.
std::vector<double> borders(int pixels, double pitch_mm) {
  std::vector<double> at(static_cast<std::size_t>(pixels) + 1);
  for (std::size_t n = 0; n < at.size(); ++n) at[n] = (static_cast<double>(n) - pixels / 2.0) * pitch_mm;
  return at;
}

}  // namespace

PixelGrid::PixelGrid(const hal::ObjectPlane& plane)
    : x_(borders(plane.cols, plane.pixel_width_mm())),
      y_(borders(plane.rows, plane.pixel_height_mm())),
      from_vertex_(x_.size()),
      rows_(plane.rows),
      cols_(plane.cols) {}

std::int64_t PixelGrid::count_touched(const ConeSection& section) {
  std::int64_t touched = 0;
  for_each_row(section, [&](int, double, double, const RowSpan& span) { touched += span.touched(); });
  return touched;
}

}  // namespace compueye::calib
