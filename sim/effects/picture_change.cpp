#include "sim/effects/picture_change.hpp"

#include <algorithm>
#include <cmath>

#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

/// Mean square over all pixels, or over those whose centres lie on the object plane, the larger.
double mean_square(const Circumstances& c, const Surface& surface, const hal::Image& change) {
  double all = 0.0, seen = 0.0;
  int seen_pixels = 0;
  for (int row = 0; row < change.rows; ++row) {
    for (int col = 0; col < change.cols; ++col) {
      const double square = std::pow(static_cast<double>(change.at(row, col)), 2);
      const double x = surface.pose.centre_mm.x + ((col + 0.5) / change.cols - 0.5) * surface.width_mm;
      const double y = surface.pose.centre_mm.y + (0.5 - (row + 0.5) / change.rows) * surface.height_mm;
      all += square;
      if (std::fabs(x) > c.board.object.width_mm / 2.0 || std::fabs(y) > c.board.object.height_mm / 2.0) continue;
      seen += square;
      ++seen_pixels;
    }
  }
  return std::max(all / static_cast<double>(change.pixels.size()), seen / std::max(seen_pixels, 1));
}

bool stays(const Circumstances& c, const Surface& surface) noexcept {
  const Pose& pose = surface.pose;
  const double distance = c.board.object.distance_mm;
  return surface.motion.still() && surface.distance_mm.value_or(distance) == distance && pose.tilt_rad == 0.0 &&
         pose.lean_rad == 0.0;
}

bool sees(const Surface& surface, const LookAt& look) noexcept {
  const double reach = std::hypot(surface.width_mm, surface.height_mm) / 2.0 + look.radius_mm;
  return std::hypot(look.x_mm - surface.pose.centre_mm.x, look.y_mm - surface.pose.centre_mm.y) <= reach;
}

}  // namespace

double picture_change_lsb(const Circumstances& c, const Surface& surface, const hal::Image& change) {
  const double unit = c.board.object.pixel_width_mm() * c.board.object.pixel_height_mm() * c.board.sensor.lsb();
  const bool fixed = stays(c, surface);
  double squares = 0.0;
  for (int m = 0; m < c.board.eye.ommatidia(); ++m) {
    const LookAt look = look_at(c, m);
    if (fixed && !sees(surface, look)) continue;
    squares += std::pow(std::min(look.area_mm2, surface.width_mm * surface.height_mm) / unit, 2);
  }
  return margin * std::sqrt(squares / c.board.eye.ommatidia() * mean_square(c, surface, change));
}

}  // namespace compueye::sim
