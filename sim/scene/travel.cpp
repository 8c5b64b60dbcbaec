#include "sim/scene/travel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace compueye::sim {
namespace {

/// How far points of the surface are from its centre along z, at most.
double half_depth_mm(const Surface& surface, const Pose& pose) noexcept {
  if (surface.shape == Shape::sphere) return surface.width_mm / 2.0;
  const hal::Vec3 right = pose.right(), up = pose.up();
  const double plane = surface.width_mm / 2.0 * std::fabs(right.z) + surface.height_mm / 2.0 * std::fabs(up.z);
  double highest = 0.0;
  for (const float height : surface.heights.pixels) highest = std::max(highest, std::fabs(static_cast<double>(height)));
  return plane + highest * std::fabs(right.x * up.y - right.y * up.x);
}

/// Where the motion may have its extremes: linear in between, but for the turning. Of a path that repeats, a drift on
/// top of it makes the first or the last round the one that goes farthest.
std::vector<double> times_of(const Motion& motion, double seconds) {
  constexpr double degree = std::numbers::pi / 180.0;
  constexpr double most_looks = 20'000.0;
  std::vector<double> times{0.0, motion.start_s, seconds};
  const double round = motion.path.empty() ? 0.0 : motion.path.back().t_s;
  double last = 0.0;
  if (motion.repeats && round > 0.0) last = std::max(std::floor((seconds - motion.start_s) / round) - 1.0, 0.0) * round;
  for (const Waypoint& waypoint : motion.path) {
    for (const double from : {0.0, last, last + round}) {
      const double t = motion.start_s + from + waypoint.t_s;
      // A round ends where the path ends, just before it begins anew.
      for (const double near : {t, std::nextafter(t, 0.0)}) times.push_back(near);
    }
  }
  const double looks = std::min(motion.turning_rad_per_s() * seconds / degree, most_looks);
  for (double look = 1.0; look < looks; look += 1.0) times.push_back(seconds * look / looks);
  for (double& t : times) t = std::clamp(t, 0.0, seconds);
  return times;
}

}  // namespace

Travel travel_of(const Surface& surface, double object_distance_mm, double seconds) {
  Pose at_rest = surface.pose;
  at_rest.centre_mm.z = surface.distance_mm.value_or(object_distance_mm);
  Motion motion = surface.motion;
  motion.steps_hz = 0.0;
  Travel travel{std::numeric_limits<double>::infinity(), 0.0, 0.0, 0.0};
  const double still_mm = half_depth_mm(surface, at_rest);
  const bool turns = motion.turning_rad_per_s() > 0.0;
  for (const double t : times_of(motion, seconds)) {
    const Pose pose = motion.moved(at_rest, t);
    const double nearest = pose.centre_mm.z - (turns ? half_depth_mm(surface, pose) : still_mm);
    const auto [x, y, z] = pose.centre_mm;
    const double farthest = std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
    if (nearest < travel.nearest_mm) travel.nearest_mm = nearest, travel.nearest_at_s = t;
    if (farthest > travel.farthest_mm) travel.farthest_mm = farthest, travel.farthest_at_s = t;
  }
  return travel;
}

}  // namespace compueye::sim
