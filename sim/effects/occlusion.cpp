#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

/// Half the sides of what a flat, upright surface covers at most, however it is rolled.
struct Box {
  double x, y, half_width, half_height;
};

Box box_of(const Surface& surface) noexcept {
  const double s = std::fabs(std::sin(surface.pose.roll_rad)), t = std::fabs(std::cos(surface.pose.roll_rad));
  return {surface.pose.centre_mm.x, surface.pose.centre_mm.y, (t * surface.width_mm + s * surface.height_mm) / 2.0,
          (s * surface.width_mm + t * surface.height_mm) / 2.0};
}

bool lies_flat(const Circumstances& c, const Surface& surface) noexcept {
  const double distance = c.board.object.distance_mm;
  return surface.shape == Shape::plane && surface.motion.still() &&
         surface.distance_mm.value_or(distance) == distance && surface.pose.tilt_rad == 0.0 &&
         surface.pose.lean_rad == 0.0;
}

bool all_lie_flat(const Circumstances& c) noexcept {
  return std::all_of(c.scene.surfaces.begin(), c.scene.surfaces.end(),
                     [&](const Surface& surface) { return lies_flat(c, surface); });
}

/// What two boxes share; negative sides where they do not meet.
Box shared(const Box& a, const Box& b) noexcept {
  const double left = std::max(a.x - a.half_width, b.x - b.half_width);
  const double right = std::min(a.x + a.half_width, b.x + b.half_width);
  const double low = std::max(a.y - a.half_height, b.y - b.half_height);
  const double high = std::min(a.y + a.half_height, b.y + b.half_height);
  return {(left + right) / 2.0, (low + high) / 2.0, (right - left) / 2.0, (high - low) / 2.0};
}

/// Where one of several flat surfaces may hide another.
std::vector<Box> overlaps(const Scene& scene) {
  std::vector<Box> found;
  for (std::size_t a = 0; a < scene.surfaces.size(); ++a) {
    for (std::size_t b = a + 1; b < scene.surfaces.size(); ++b) {
      const Box box = shared(box_of(scene.surfaces[a]), box_of(scene.surfaces[b]));
      if (box.half_width > 0.0 && box.half_height > 0.0) found.push_back(box);
    }
  }
  return found;
}

bool has_relief(const Scene& scene) noexcept {
  return std::any_of(scene.surfaces.begin(), scene.surfaces.end(),
                     [](const Surface& surface) { return surface.shape == Shape::relief; });
}

std::string calls_for(const Circumstances& c) {
  if (has_relief(c.scene)) return "a relief may hide parts of itself";
  if (c.scene.surfaces.size() < 2) return "";
  const std::string count = std::to_string(c.scene.surfaces.size()) + " surfaces";
  if (!all_lie_flat(c)) return count + " may come before each other";
  const std::size_t places = overlaps(c.scene).size();
  return places > 0 ? count + " overlap in " + std::to_string(places) + " places" : "";
}

// Without it the light of all surfaces adds up, so what is hidden is part of the preview's levels: at most all of the
// level of each channel that looks at an overlap; of every channel where things move or stand in depth, and then it may
// be what comes into the look.
double bound(const Circumstances& c) {
  if (c.preview.shine_through_change) return looked_bound(*c.preview.shine_through_change);
  const bool flat = all_lie_flat(c);
  const std::vector<Box> places = overlaps(c.scene);
  double squares = 0.0;
  for (int m = 0; m < c.board.eye.ommatidia(); ++m) {
    const LookAt look = look_at(c, m);
    const bool hides = !flat || std::any_of(places.begin(), places.end(), [&](const Box& box) {
      return std::fabs(look.x_mm - box.x) <= box.half_width + look.radius_mm &&
             std::fabs(look.y_mm - box.y) <= box.half_height + look.radius_mm;
    });
    if (hides) squares += std::pow(c.preview.levels[static_cast<std::size_t>(m)], 2);
  }
  const double hidden = margin * std::sqrt(squares / c.board.eye.ommatidia());
  return flat ? hidden : std::max(hidden, brightest(c) * white_lsb(c) / 4.0);
}

}  // namespace

const Effect effect::occlusion{
    .name = "occlusion",
    .group = EffectGroup::scene,
    .model = "along a ray the nearest surface alone is seen",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return render_once_cost(c, 2.0); },
    .apply = [](const Circumstances&, Workings& w) { w.render.occlusion = true; },
};

}  // namespace compueye::sim
