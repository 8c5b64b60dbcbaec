#include <cmath>

#include "sim/effects/build_draws.hpp"
#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"

namespace compueye::sim {
namespace {

constexpr std::string_view own_name = "misalignment";
constexpr double rad_per_deg = 0.017453292519943295;

/// How one ommatidium came out.
struct Pose6 {
  double first_rad, second_rad;  ///< of its axis, about two directions across it
  hal::Vec3 apex_mm;
};

Pose6 drawn(const hal::BuildSettings& build, int m) noexcept {
  RandomStream random = build_draws(build, own_name, m);
  const double angle = build.pose_rms_deg * rad_per_deg, length = build.apex_rms_mm;
  Pose6 pose{};
  pose.first_rad = angle * random.gaussian();
  pose.second_rad = angle * random.gaussian();
  pose.apex_mm.x = length * random.gaussian();
  pose.apex_mm.y = length * random.gaussian();
  pose.apex_mm.z = length * random.gaussian();
  return pose;
}

std::string calls_for(const Circumstances& c) {
  const hal::BuildSettings& build = c.board.build;
  if (build.pose_rms_deg == 0.0 && build.apex_rms_mm == 0.0) return "";
  return "axes are off by " + figure(build.pose_rms_deg) + " deg, apexes by " + figure(build.apex_rms_mm) + " mm";
}

// As drawn, by shifted_change_lsb.
double bound(const Circumstances& c) {
  std::vector<double> turns, moves;
  for (int m = 0; m < c.board.eye.ommatidia(); ++m) {
    const Pose6 pose = drawn(c.board.build, m);
    turns.push_back(std::hypot(pose.first_rad, pose.second_rad));
    moves.push_back(std::hypot(pose.apex_mm.x, pose.apex_mm.y, pose.apex_mm.z));
  }
  return shifted_change_lsb(c, turns, moves);
}

void apply(const Circumstances& c, Workings& w) {
  for (std::size_t m = 0; m < w.optics.ommatidia.size(); ++m) {
    const Pose6 pose = drawn(c.board.build, static_cast<int>(m));
    OmmatidiumOptics& optics = w.optics.ommatidia[m];
    optics.apex_mm.x += pose.apex_mm.x;
    optics.apex_mm.y += pose.apex_mm.y;
    optics.apex_mm.z += pose.apex_mm.z;
    for (ConeOfLight& cone : optics.cones) {
      const Across directions = across(cone.axis);
      cone.axis = turned(turned(cone.axis, directions.first, pose.first_rad), directions.second, pose.second_rad);
    }
  }
}

}  // namespace

const Effect effect::misalignment{
    .name = own_name,
    .group = EffectGroup::optics,
    .model =
        "axes turned by N(0, pose) about two directions, apexes moved by N(0, apex) along three, as drawn at random",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost =
        [](const Circumstances& c) {
          return EffectCost{step_cost(c, 300.0).frame_s, 0.0};
        },
    .apply = apply,
};

}  // namespace compueye::sim
