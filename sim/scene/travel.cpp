#include "sim/scene/travel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
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
/// top of it makes the first or the last round the one that goes farthest. In ascending order.
std::vector<double> times_of(const Motion& motion, double seconds) {
  constexpr double degree = std::numbers::pi / 180.0;
  constexpr double most_looks = 20'000.0;
  std::vector<double> times{0.0, motion.start_s, seconds};
  const double round = motion.path.empty() ? 0.0 : motion.path.back().t_s;
  std::vector<double> rounds{0.0};
  if (motion.repeats && round > 0.0) {
    const double last = std::max(std::floor((seconds - motion.start_s) / round), 1.0);
    const double most = std::min(last, std::floor(most_looks / static_cast<double>(motion.path.size())));
    for (double n = 1.0; n < most; n += 1.0) rounds.push_back(n * round);
    rounds.insert(rounds.end(), {(last - 1.0) * round, last * round});
  }
  for (const double from : rounds) {
    for (const Waypoint& waypoint : motion.path) {
      const double t = motion.start_s + from + waypoint.t_s;
      // A round ends where the path ends, just before it begins anew.
      times.insert(times.end(), {std::nextafter(t, 0.0), t});
    }
  }
  const double looks = std::min(motion.turning_rad_per_s() * seconds / degree, most_looks);
  for (double look = 1.0; look < looks; look += 1.0) times.push_back(seconds * look / looks);
  for (double& t : times) t = std::clamp(t, 0.0, seconds);
  std::sort(times.begin(), times.end());
  return times;
}

/// A surface on its way, from the lens tip.
class Way {
 public:
  Way(const Surface& surface, double object_distance_mm) : surface_(surface), motion_(surface.motion) {
    at_rest_ = surface.pose;
    at_rest_.centre_mm.z = surface.distance_mm.value_or(object_distance_mm);
    motion_.steps_hz = 0.0;
    still_mm_ = half_depth_mm(surface, at_rest_);
    turns_ = motion_.turning_rad_per_s() > 0.0;
  }
  [[nodiscard]] const Motion& motion() const noexcept { return motion_; }
  [[nodiscard]] double nearest_mm(double t) const noexcept {
    const Pose pose = motion_.moved(at_rest_, t);
    return pose.centre_mm.z - (turns_ ? half_depth_mm(surface_, pose) : still_mm_);
  }
  [[nodiscard]] double farthest_mm(double t) const noexcept {
    const auto [x, y, z] = motion_.moved(at_rest_, t).centre_mm;
    return std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
  }

 private:
  const Surface& surface_;
  Motion motion_;
  Pose at_rest_;
  double still_mm_ = 0.0;
  bool turns_ = false;
};

/// Between a time at which something is not so yet and one at which it is.
template <class IsSo>
double first_time(double before, double after, const IsSo& is_so) {
  constexpr int halvings = 60;
  for (int n = 0; n < halvings && before < after; ++n) {
    const double middle = std::midpoint(before, after);
    (is_so(middle) ? after : before) = middle;
  }
  return after;
}

}  // namespace

Travel travel_of(const Surface& surface, double object_distance_mm, double seconds, double limit_mm) {
  const Way way(surface, object_distance_mm);
  const auto inside = [&](double t) { return !(way.nearest_mm(t) > 0.0); };
  const auto too_far = [&](double t) { return !(way.farthest_mm(t) <= limit_mm); };
  Travel travel{std::numeric_limits<double>::infinity(), {}, 0.0, {}};
  double before = 0.0;
  for (const double t : times_of(way.motion(), seconds)) {
    travel.nearest_mm = std::min(travel.nearest_mm, way.nearest_mm(t));
    travel.farthest_mm = std::max(travel.farthest_mm, way.farthest_mm(t));
    if (!travel.inside_at_s && inside(t)) travel.inside_at_s = first_time(before, t, inside);
    if (!travel.too_far_at_s && too_far(t)) travel.too_far_at_s = first_time(before, t, too_far);
    before = t;
  }
  return travel;
}

}  // namespace compueye::sim
