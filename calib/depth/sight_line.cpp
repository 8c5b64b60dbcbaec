#include "calib/depth/sight_line.hpp"

namespace compueye::calib {

bool on(const hal::ObjectPlane& plane, const PlacePx& at) noexcept {
  return at.row >= -0.5 && at.col >= -0.5 && at.row <= plane.rows - 0.5 && at.col <= plane.cols - 0.5;
}

hal::ObjectPlane at_distance(hal::ObjectPlane plane, double distance_mm) noexcept {
  plane.distance_mm = distance_mm;
  return plane;
}

SightLine::SightLine(const hal::EyeGeometry& eye, int i, int k, const Display& from, const Display& to) noexcept
    : cols_(from.plane.cols) {
  const hal::Vec3 apex = eye.apex(i, k);
  const hal::ObjectPlane& plane = from.plane;
  apex_row_px_ = (plane.height_mm / 2.0 - apex.y) / plane.height_mm * plane.rows - 0.5;
  apex_col_px_ = (plane.width_mm / 2.0 + apex.x) / plane.width_mm * plane.cols - 0.5;
  const auto height = [&](const Display& display) { return display.plane.z_mm(eye) + display.farther_mm - apex.z; };
  ratio_ = height(to) / height(from);
}

PlacePx SightLine::through(std::int32_t pixel) const noexcept {
  const int row = pixel / cols_, col = pixel % cols_;
  return {apex_row_px_ + ratio_ * (row - apex_row_px_), apex_col_px_ + ratio_ * (col - apex_col_px_)};
}

}  // namespace compueye::calib
