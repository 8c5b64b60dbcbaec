#include "sim/effects/picture_change.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

bool stays(const Circumstances& c, const Surface& surface) noexcept {
  const Pose& pose = surface.pose;
  const double distance = c.board.object.distance_mm;
  return surface.motion.still() && surface.distance_mm.value_or(distance) == distance && pose.tilt_rad == 0.0 &&
         pose.lean_rad == 0.0;
}

/// Of the pixel at a place of the object plane; 0 beside the surface.
double change_at(const Surface& surface, const hal::Image& change, double x_mm, double y_mm) noexcept {
  const double col = ((x_mm - surface.pose.centre_mm.x) / surface.width_mm + 0.5) * change.cols;
  const double row = (0.5 - (y_mm - surface.pose.centre_mm.y) / surface.height_mm) * change.rows;
  if (!(col >= 0.0 && col < change.cols && row >= 0.0 && row < change.rows)) return 0.0;
  return static_cast<double>(change.at(static_cast<int>(row), static_cast<int>(col)));
}

/// Integral over a look narrower than the surface, by places evenly spread over it.
double narrow_change_mm2(const LookAt& look, const Surface& surface, const hal::Image& change) noexcept {
  constexpr int rings = 6, spokes = 16;
  double sum = 0.0;
  for (int ring = 0; ring < rings; ++ring) {
    const double radius = look.radius_mm * std::sqrt((ring + 0.5) / rings);
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double angle = 2.0 * std::numbers::pi * (spoke + 0.5 * (ring % 2)) / spokes;
      sum += change_at(surface, change, look.x_mm + radius * std::cos(angle), look.y_mm + radius * std::sin(angle));
    }
  }
  return look.area_mm2 * sum / (rings * spokes);
}

/// The same of any look, by places evenly spread over the surface.
double wide_change_mm2(const Circumstances& c, int m, const Surface& surface, const hal::Image& change) noexcept {
  constexpr int side = 24;
  const hal::EyeGeometry& eye = c.board.eye;
  const hal::Vec3 apex = eye.apex(m / eye.columns, m % eye.columns), axis = eye.axis(m / eye.columns, m % eye.columns);
  const double z = c.board.object.z_mm(eye) - apex.z, cosine = std::cos(eye.acceptance_rad / 2.0);
  double sum = 0.0;
  for (int i = 0; i < side; ++i) {
    for (int k = 0; k < side; ++k) {
      const double x = surface.pose.centre_mm.x + ((k + 0.5) / side - 0.5) * surface.width_mm;
      const double y = surface.pose.centre_mm.y + ((i + 0.5) / side - 0.5) * surface.height_mm;
      const double right = x - apex.x, up = y - apex.y;
      const double along = right * axis.x + up * axis.y + z * axis.z;
      if (along >= cosine * std::sqrt(right * right + up * up + z * z)) sum += change_at(surface, change, x, y);
    }
  }
  return surface.width_mm * surface.height_mm * sum / (side * side);
}

double change_mm2(const Circumstances& c, int m, const Surface& surface, const hal::Image& change) noexcept {
  const LookAt look = look_at(c, m);
  return look.radius_mm < std::min(surface.width_mm, surface.height_mm) / 3.0 ? narrow_change_mm2(look, surface, change)
                                                                              : wide_change_mm2(c, m, surface, change);
}

double mean_square(const hal::Image& change) noexcept {
  double sum = 0.0;
  for (const float each : change.pixels) sum += static_cast<double>(each) * static_cast<double>(each);
  return sum / static_cast<double>(change.pixels.size());
}

}  // namespace

double picture_change_lsb(const Circumstances& c, const Surface& surface, const hal::Image& change) {
  const double unit = c.board.object.pixel_width_mm() * c.board.object.pixel_height_mm() * c.board.sensor.lsb();
  hal::Image ones(1, 1);
  ones.pixels = {1.0F};
  double squares = 0.0, areas = 0.0, looks = 0.0;
  for (int m = 0; m < c.board.eye.ommatidia(); ++m) {
    squares += std::pow(change_mm2(c, m, surface, change), 2);
    areas += std::pow(change_mm2(c, m, surface, ones), 2);
    looks += std::pow(std::min(look_at(c, m).area_mm2, surface.width_mm * surface.height_mm), 2);
  }
  if (!stays(c, surface)) squares = (areas > 0.0 ? areas : looks) * mean_square(change);
  return margin / unit * std::sqrt(squares / c.board.eye.ommatidia());
}

}  // namespace compueye::sim
