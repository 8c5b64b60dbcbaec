#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"

namespace compueye::sim {
namespace {

/// How far points of a surface are from the object plane at most, mm in depth, over the time looked at.
double depth_mm(const Circumstances& c, const Surface& surface) noexcept {
  const double distance = c.board.object.distance_mm;
  const double corner = std::hypot(surface.width_mm, surface.height_mm) / 2.0;
  const Motion& motion = surface.motion;
  const bool still = motion.still();
  const Pose end = motion.moved(surface.pose, c.scene.seconds_to_judge());
  double turned = std::hypot(surface.pose.tilt_rad, surface.pose.lean_rad);
  double farther = std::fabs(surface.distance_mm.value_or(distance) - distance);
  if (!still) {
    turned = std::max(turned, std::hypot(end.tilt_rad, end.lean_rad));
    farther += std::fabs(end.centre_mm.z - surface.pose.centre_mm.z);
    double path = 0.0;
    for (const Waypoint& at : motion.path) path = std::max(path, std::fabs(at.offset_mm.z));
    farther += path;
  }
  double relief = surface.shape == Shape::sphere ? surface.width_mm / 2.0 : 0.0;
  for (const float height : surface.heights.pixels) relief = std::max(relief, std::fabs(static_cast<double>(height)));
  return farther + corner * std::sin(std::min(turned, 1.5)) + relief;
}

double deepest_mm(const Circumstances& c) noexcept {
  double most = 0.0;
  for (const Surface& surface : c.scene.surfaces) most = std::max(most, depth_mm(c, surface));
  return most;
}

std::string calls_for(const Circumstances& c) {
  const double deepest = deepest_mm(c);
  if (deepest <= 1e-9 * c.board.object.distance_mm) return "";
  return "something is up to " + figure(deepest) + " mm off the plane at " + figure(c.board.object.distance_mm) + " mm";
}

// A ray that meets the object plane at p, seen from its apex at a (across z), at range r, meets a surface dL behind it
// at p + (p - a) dL / r: every look is moved by at most corner dL / r, and a level changes by at most its gradient
// times that (rms over channels: the preview's); nearer by dL, the same over r - dL. What is moved farther than a
// quarter of the plane shows something that the flat look does not: about as bright as the levels are, or a good part
// of a look full of the brightest.
double bound(const Circumstances& c) {
  if (c.preview.flat_change) return looked_bound(*c.preview.flat_change);
  const double depth = deepest_mm(c), range = range_mm(c);
  const double corner = std::hypot(c.board.object.width_mm, c.board.object.height_mm) / 2.0;
  const double moved = corner * depth / std::max(range - depth, 0.1 * range);
  const double along = margin * steepness_lsb_per_mm(c) * moved;
  if (moved < corner / 2.0) return along;
  return std::max(std::min(along, 3.0 * c.preview.rms), brightest(c) * white_lsb(c) / 4.0);
}

}  // namespace

const Effect effect::off_plane{
    .name = "off_plane",
    .group = EffectGroup::scene,
    .model = "rays meet surfaces where they are: distance, tilt, relief",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return render_once_cost(c, 1.0); },
    .apply = [](const Circumstances&, Workings& w) { w.render.true_depth = true; },
};

}  // namespace compueye::sim
