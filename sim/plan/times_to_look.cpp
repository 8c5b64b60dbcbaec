#include "sim/plan/times_to_look.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace compueye::sim {
namespace {

constexpr int most_surfaces = 16;

/// Of what is judged; irrational, so that no period of seconds divides their distances.
constexpr std::array shares{std::numbers::sqrt3 - 1.6, std::numbers::sqrt2 - 1.04, std::numbers::phi - 1.0,
                            std::numbers::pi - 2.25};

/// The way of a surface's centre between two times at which it may bend.
struct Leg {
  double from_s, to_s;
  hal::Vec3 from, to;

  /// When it is nearest to the z axis.
  [[nodiscard]] double nearest_s() const noexcept {
    const double dx = to.x - from.x, dy = to.y - from.y, squares = dx * dx + dy * dy;
    if (!(squares > 0.0)) return from_s;
    const double share = std::clamp(-(from.x * dx + from.y * dy) / squares, 0.0, 1.0);
    return from_s + share * (to_s - from_s);
  }
};

/// Where its way may bend in the first round of its path, and at the end.
std::vector<double> bends_of(const Motion& motion, double seconds) {
  std::vector<double> times{0.0, motion.start_s};
  for (const Waypoint& waypoint : motion.path) {
    const double t = motion.start_s + waypoint.t_s;
    times.push_back(std::nextafter(t, 0.0));  // a round ends just before the next one begins
    times.push_back(t);
  }
  times.push_back(seconds);
  for (double& t : times) t = std::min(t, seconds);
  std::sort(times.begin(), times.end());
  return times;
}

double squared_from_axis(const hal::Vec3& at) noexcept {
  return at.x * at.x + at.y * at.y;
}

void add_places(const Surface& surface, double seconds, std::vector<double>& times) {
  Motion motion = surface.motion;
  motion.steps_hz = 0.0;
  const auto at = [&](double t_s) { return motion.moved(surface.pose, t_s).centre_mm; };
  const std::vector<double> bends = bends_of(motion, seconds);
  double nearest_s = 0.0, farthest_s = 0.0, farthest = 0.0;
  for (std::size_t k = 0; k + 1 < bends.size(); ++k) {
    const Leg leg{bends[k], bends[k + 1], at(bends[k]), at(bends[k + 1])};
    if (const double t = leg.nearest_s(); squared_from_axis(at(t)) < squared_from_axis(at(nearest_s))) nearest_s = t;
  }
  for (const Waypoint& waypoint : motion.path) {
    if (const double mm = length(waypoint.offset_mm); mm > farthest) {
      farthest = mm;
      farthest_s = std::nextafter(motion.start_s + waypoint.t_s, 0.0);
    }
  }
  times.insert(times.end(), {nearest_s, farthest_s});
}

void add_turns(const Motion& motion, std::vector<double>& times) {
  const double fastest =
      std::max({std::fabs(motion.tilt_rad_per_s), std::fabs(motion.lean_rad_per_s), std::fabs(motion.roll_rad_per_s)});
  if (!(fastest > 0.0)) return;
  constexpr double quarter = std::numbers::pi / 2.0, golden = 2.0 * std::numbers::pi * (2.0 - std::numbers::phi);
  for (const double turn : {quarter, golden}) times.push_back(motion.start_s + turn / fastest);
}

}  // namespace

std::vector<double> times_to_look(const Scene& scene) {
  std::vector<double> times{0.0};
  if (scene.still()) return times;
  const double seconds = scene.seconds_to_judge();
  int own = 0;
  for (const Surface& surface : scene.surfaces) {
    if (surface.motion.still() || own++ >= most_surfaces) continue;
    add_places(surface, seconds, times);
    add_turns(surface.motion, times);
  }
  for (const double share : shares) times.push_back(share * seconds);
  std::erase_if(times, [&](double t_s) { return !(t_s >= 0.0 && t_s <= seconds); });
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace compueye::sim
