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

/// Mean over a look's places, evenly spread.
double mean_change(const LookAt& look, const Surface& surface, const hal::Image& change) noexcept {
  constexpr int rings = 6, spokes = 16;
  double sum = 0.0;
  for (int ring = 0; ring < rings; ++ring) {
    const double radius = look.radius_mm * std::sqrt((ring + 0.5) / rings);
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double angle = 2.0 * std::numbers::pi * (spoke + 0.5 * (ring % 2)) / spokes;
      sum += change_at(surface, change, look.x_mm + radius * std::cos(angle), look.y_mm + radius * std::sin(angle));
    }
  }
  return sum / (rings * spokes);
}

}  // namespace

double picture_change_lsb(const Circumstances& c, const Surface& surface, const hal::Image& change) {
  const double unit = c.board.object.pixel_width_mm() * c.board.object.pixel_height_mm() * c.board.sensor.lsb();
  const double side = surface.width_mm * surface.height_mm;
  double mean_square = 0.0, squares = 0.0;
  for (const float each : change.pixels) mean_square += static_cast<double>(each) * static_cast<double>(each);
  mean_square /= static_cast<double>(change.pixels.size());
  const bool fixed = stays(c, surface);
  for (int m = 0; m < c.board.eye.ommatidia(); ++m) {
    const LookAt look = look_at(c, m);
    const double square = fixed ? std::pow(mean_change(look, surface, change), 2) : mean_square;
    squares += std::pow((fixed ? look.area_mm2 : std::min(look.area_mm2, side)) / unit, 2) * square;
  }
  return margin * std::sqrt(squares / c.board.eye.ommatidia());
}

}  // namespace compueye::sim
