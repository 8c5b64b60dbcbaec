#include "sim/scene/motion.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::sim {
namespace {

hal::Vec3 turned(const Pose& pose, hal::Vec3 v) noexcept {
  const double cr = std::cos(pose.roll_rad), sr = std::sin(pose.roll_rad);
  v = {cr * v.x - sr * v.y, sr * v.x + cr * v.y, v.z};
  const double cl = std::cos(pose.lean_rad), sl = std::sin(pose.lean_rad);
  v = {v.x, cl * v.y - sl * v.z, sl * v.y + cl * v.z};
  const double ct = std::cos(pose.tilt_rad), st = std::sin(pose.tilt_rad);
  return {ct * v.x - st * v.z, v.y, st * v.x + ct * v.z};
}

hal::Vec3 between(const hal::Vec3& a, const hal::Vec3& b, double share) noexcept {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z + share * (b.z - a.z)};
}

/// Where the path is at t >= 0 after its start.
hal::Vec3 on_path(const std::vector<Waypoint>& path, bool repeats, double t) noexcept {
  if (path.empty()) return {};
  const double end = path.back().t_s;
  if (repeats && end > 0.0) t = std::fmod(t, end);
  if (t <= path.front().t_s) return path.front().offset_mm;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Waypoint &from = path[k - 1], &to = path[k];
    if (t < to.t_s) return between(from.offset_mm, to.offset_mm, (t - from.t_s) / (to.t_s - from.t_s));
  }
  return path.back().offset_mm;
}

}  // namespace

hal::Vec3 Pose::right() const noexcept {
  return turned(*this, {1.0, 0.0, 0.0});
}
hal::Vec3 Pose::up() const noexcept {
  return turned(*this, {0.0, 1.0, 0.0});
}

bool Motion::still() const noexcept {
  return speed_mm_per_s() == 0.0 && turning_rad_per_s() == 0.0;
}

Pose Motion::moved(const Pose& from, double t_s) const noexcept {
  if (steps_hz > 0.0) t_s = std::floor(t_s * steps_hz) / steps_hz;
  const double t = t_s - start_s;
  if (!(t > 0.0)) return from;
  const hal::Vec3 offset = on_path(path, repeats, t);
  Pose pose = from;
  pose.centre_mm.x += velocity_mm_per_s.x * t + offset.x;
  pose.centre_mm.y += velocity_mm_per_s.y * t + offset.y;
  pose.centre_mm.z += velocity_mm_per_s.z * t + offset.z;
  pose.tilt_rad += tilt_rad_per_s * t;
  pose.lean_rad += lean_rad_per_s * t;
  pose.roll_rad += roll_rad_per_s * t;
  return pose;
}

double Motion::speed_mm_per_s() const noexcept {
  double fastest = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const hal::Vec3 &to = path[k].offset_mm, &from = path[k - 1].offset_mm;
    const double far = length(to - from);
    fastest = std::max(fastest, far / (path[k].t_s - path[k - 1].t_s));
  }
  return length(velocity_mm_per_s) + fastest;
}

double Motion::turning_rad_per_s() const noexcept {
  return std::fabs(tilt_rad_per_s) + std::fabs(lean_rad_per_s) + std::fabs(roll_rad_per_s);
}

}  // namespace compueye::sim
