#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

/// Of the light at a distance squared from the axis of the eye.
double light_at(const Circumstances& c, double square_mm2) noexcept {
  const hal::ObjectPlane& object = c.board.object;
  const double corner2 = (object.width_mm * object.width_mm + object.height_mm * object.height_mm) / 4.0;
  return std::max(1.0 - c.scene.light.falloff * square_mm2 / corner2, 0.0);
}

std::string calls_for(const Circumstances& c) {
  const bool lit = std::any_of(c.scene.surfaces.begin(), c.scene.surfaces.end(),
                               [](const Surface& surface) { return !surface.shines; });
  if (!lit || c.scene.light.falloff == 0.0) return "";
  return "corners get " + figure(100.0 * c.scene.light.falloff) + " % less light";
}

// No channel loses a larger share than the farthest point of its look does.
double bound(const Circumstances& c) {
  double squares = 0.0;
  for (int m = 0; m < c.board.eye.ommatidia(); ++m) {
    const LookAt look = look_at(c, m);
    const double farthest = std::hypot(look.x_mm, look.y_mm) + look.radius_mm;
    const double loss = std::fabs(1.0 - light_at(c, farthest * farthest));
    squares += std::pow(loss * c.preview.levels[static_cast<std::size_t>(m)], 2);
  }
  return margin * std::sqrt(squares / c.board.eye.ommatidia());
}

/// Each pixel divided into so many rows and columns.
hal::Image divided(const hal::Image& picture, int rows, int cols) {
  hal::Image fine(picture.rows * rows, picture.cols * cols);
  for (int row = 0; row < fine.rows; ++row) {
    for (int col = 0; col < fine.cols; ++col) fine.at(row, col) = picture.at(row / rows, col / cols);
  }
  return fine;
}

/// Rows or columns that a pixel is divided into: the light changes by little over a fortieth of the object plane.
int parts(double side_mm, int pixels, double plane_mm) noexcept {
  return static_cast<int>(std::clamp(std::ceil(40.0 * side_mm / pixels / plane_mm), 1.0, 64.0));
}

void light_up(const Circumstances& c, const Surface& surface, bool in_depth, hal::Image& picture) {
  picture = divided(picture, parts(surface.height_mm, picture.rows, c.board.object.height_mm),
                    parts(surface.width_mm, picture.cols, c.board.object.width_mm));
  const hal::Vec3 right = in_depth ? surface.pose.right() : hal::Vec3{1.0, 0.0, 0.0};
  const hal::Vec3 up = in_depth ? surface.pose.up() : hal::Vec3{0.0, 1.0, 0.0};
  for (int row = 0; row < picture.rows; ++row) {
    const double v = (0.5 - (row + 0.5) / picture.rows) * surface.height_mm;
    for (int col = 0; col < picture.cols; ++col) {
      const double u = ((col + 0.5) / picture.cols - 0.5) * surface.width_mm;
      const double x = surface.pose.centre_mm.x + u * right.x + v * up.x;
      const double y = surface.pose.centre_mm.y + u * right.y + v * up.y;
      float& pixel = picture.at(row, col);
      pixel = static_cast<float>(light_at(c, x * x + y * y) * static_cast<double>(pixel));
    }
  }
}

void apply(const Circumstances& c, Workings& w) {
  if (c.scene.light.falloff == 0.0) return;
  for (Surface& surface : w.scene.surfaces) {
    if (surface.shines) continue;
    for (hal::Image& band : surface.bands) light_up(c, surface, w.render.true_depth, band);
  }
}

}  // namespace

const Effect effect::light_falloff{
    .name = "light_falloff",
    .group = EffectGroup::scene,
    .model = "light 1 - falloff (r / corner)^2 on what is lit, where it stands at the start",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost =
        [](const Circumstances&) {
          return EffectCost{1e-2, 0.0};
        },
    .apply = apply,
};

}  // namespace compueye::sim
