#include "calib/check/turn_slopes.hpp"

#include <cstddef>
#include <cstdint>

namespace compueye::calib {
namespace {

/// Of a picture, per mm, x to the right and y up. Rows end at the display's border, so its last pixels stand for the
/// slope beyond it, too.
struct Slopes {
  std::vector<double> x, y;
};

Slopes slopes_of(const hal::Image& picture, const hal::ObjectPlane& plane) {
  const int rows = picture.rows, cols = picture.cols;
  const auto at = [&](int row, int col) {
    if (row < 0 || row >= rows || col < 0 || col >= cols) return 0.0;
    return static_cast<double>(
        picture.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col)]);
  };
  Slopes slopes;
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      double right = at(row, col + 1) - at(row, col - 1), up = at(row - 1, col) - at(row + 1, col);
      if (col == 0) right += at(row, 0);
      if (col == cols - 1) right -= at(row, col);
      if (row == 0) up -= at(0, col);
      if (row == rows - 1) up += at(row, col);
      slopes.x.push_back(right / (2.0 * plane.pixel_width_mm()));
      slopes.y.push_back(up / (2.0 * plane.pixel_height_mm()));
    }
  }
  return slopes;
}

struct Shift {
  double x = 0.0, y = 0.0;
};

/// How far a point of the plane goes, seen from `apex`, for each radian that the eye turns about each axis.
std::array<Shift, turn_axes> shifts(const hal::Vec3& point, const hal::Vec3& apex) noexcept {
  // The point turns by - axis x point; back onto the plane it comes along the ray from the apex.
  const std::array<hal::Vec3, turn_axes> moved{hal::Vec3{0.0, point.z, -point.y}, hal::Vec3{-point.z, 0.0, point.x},
                                               hal::Vec3{point.y, -point.x, 0.0}};
  const double depth = point.z - apex.z;
  std::array<Shift, turn_axes> all;
  for (std::size_t a = 0; a < turn_axes; ++a) {
    all[a] = {moved[a].x - (point.x - apex.x) * moved[a].z / depth,
              moved[a].y - (point.y - apex.y) * moved[a].z / depth};
  }
  return all;
}

}  // namespace

std::vector<std::array<double, turn_axes>> turn_slopes(const recon::Response& rows, const hal::EyeGeometry& eye,
                                                       const hal::ObjectPlane& plane, const hal::Image& picture) {
  const Slopes slopes = slopes_of(picture, plane);
  std::vector<std::array<double, turn_axes>> all(static_cast<std::size_t>(rows.rows()));
  for (int m = 0; m < rows.rows(); ++m) {
    const hal::Vec3 apex = eye.apex(m / eye.columns, m % eye.columns);
    std::array<double, turn_axes>& sums = all[static_cast<std::size_t>(m)];
    rows.for_each_in_row(m, [&](std::int32_t n, double value) {
      const auto pixel = static_cast<std::size_t>(n);
      const double along_x = slopes.x[pixel], along_y = slopes.y[pixel];
      if (along_x == 0.0 && along_y == 0.0) return;
      const hal::Vec3 point{(n % plane.cols + 0.5) * plane.pixel_width_mm() - 0.5 * plane.width_mm,
                            0.5 * plane.height_mm - (n / plane.cols + 0.5) * plane.pixel_height_mm(), plane.z_mm(eye)};
      const auto moved = shifts(point, apex);
      for (std::size_t a = 0; a < turn_axes; ++a) {
        sums[a] -= value * (along_x * moved[a].x + along_y * moved[a].y);
      }
    });
  }
  return all;
}

}  // namespace compueye::calib
