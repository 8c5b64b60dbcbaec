#include "sim/effects/estimates.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace compueye::sim {

std::string figure(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

double speed_mm_per_s(const Surface& surface) noexcept {
  const double corner = std::hypot(surface.width_mm, surface.height_mm) / 2.0;
  return surface.motion.speed_mm_per_s() + surface.motion.turning_rad_per_s() * corner;
}

double speed_mm_per_s(const Circumstances& c) noexcept {
  double fastest = 0.0;
  for (const Surface& surface : c.scene.surfaces) fastest = std::max(fastest, speed_mm_per_s(surface));
  return fastest;
}

double steepness_lsb_per_mm(const Circumstances& c) noexcept {
  return std::numbers::sqrt2 * c.preview.gradient_rms;
}

double looked_bound(double change_lsb) noexcept {
  return 2.0 * change_lsb;
}

double range_mm(const Circumstances& c) noexcept {
  const hal::EyeGeometry& eye = c.board.eye;
  return std::max(c.board.object.z_mm(eye) - eye.apex(eye.rows / 2, eye.columns / 2).z, 1e-9);
}

double look_radius_mm(const Circumstances& c) noexcept {
  return range_mm(c) * std::tan(c.board.eye.acceptance_rad / 2.0);
}

double white_lsb(const Circumstances& c) noexcept {
  const double radius = look_radius_mm(c);
  const double pixel = c.board.object.pixel_width_mm() * c.board.object.pixel_height_mm();
  return std::numbers::pi * radius * radius / pixel / c.board.sensor.lsb();
}

double brightest(const Circumstances& c) noexcept {
  double most = 0.0;
  for (const Surface& surface : c.scene.surfaces) {
    const double light = surface.shines ? 1.0 : c.scene.light.level;
    for (const hal::Image& band : surface.bands) {
      for (const float pixel : band.pixels) most = std::max(most, light * static_cast<double>(pixel));
    }
  }
  return most;
}

EffectCost step_cost(const Circumstances& c, double ns) noexcept {
  return {0.0, ns * 1e-9 * c.board.eye.ommatidia()};
}

EffectCost render_cost(const Circumstances& c, double renders) noexcept {
  constexpr double ommatidium_s = 30e-6;  // of one surface
  return {0.0, renders * ommatidium_s * c.board.eye.ommatidia() * static_cast<double>(c.scene.surfaces.size())};
}

EffectCost render_once_cost(const Circumstances& c, double renders) noexcept {
  const double once = render_cost(c, renders).frame_s;
  return {once, c.scene.still() ? 0.0 : once};
}

}  // namespace compueye::sim
