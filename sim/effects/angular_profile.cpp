#include <algorithm>
#include <cmath>

#include "sim/effects/effect_list.hpp"
#include "sim/effects/estimates.hpp"
#include "sim/effects/looks.hpp"
#include "sim/effects/profile_stack.hpp"

namespace compueye::sim {
namespace {

std::vector<ProfileShell> stack_of(const Circumstances& c) {
  const double widest = widest_half_rad / (c.board.eye.acceptance_rad / 2.0);
  return profile_stack(c.board.build.profile, c.board.build.edge_order, std::max(widest, 1.0));
}

std::string calls_for(const Circumstances& c) {
  switch (c.board.build.profile) {
    case hal::ProfileKind::flat_top:
      return "";
    case hal::ProfileKind::soft:
      return "acceptance falls softly, order " + figure(c.board.build.edge_order);
    case hal::ProfileKind::airy:
      return "acceptance is an Airy disc";
  }
  return "";
}

// To second order in the angle a level is its light times the brightness at the axis plus, by direction, half the mean
// square of the angle times the second derivative: another profile changes it by the light's change and by half the
// change of the mean square times the sum of second derivatives (at most 2 of the larger). Rings reach so far that this
// says nothing; then the light that comes from elsewhere is at most as bright as the picture is. Where a picture ends
// within oblique looks a fifth of that light is seen to be lost or won.
double bound(const Circumstances& c) {
  const ProfileMoments profile = moments(stack_of(c));
  const double radius = look_radius_mm(c);
  const double light = std::fabs(profile.light - 1.0) * c.preview.rms;
  const double square = std::fabs(profile.light * profile.square - 0.5) * radius * radius / 2.0;
  return margin * std::min(light + square * c.preview.laplacian_rms + 0.2 * profile.apart * c.preview.rms,
                           profile.apart * c.preview.rms);
}

void apply(const Circumstances& c, Workings& w) {
  const std::vector<ProfileShell> stack = stack_of(c);
  for (OmmatidiumOptics& optics : w.optics.ommatidia) {
    std::vector<ConeOfLight> cones;
    for (const ConeOfLight& cone : optics.cones) {
      for (const ProfileShell& shell : stack) {
        const double half = std::min(cone.half_angle_rad * shell.ratio, widest_half_rad);
        cones.push_back({cone.axis, half, cone.weight * shell.weight});
      }
    }
    optics.cones = std::move(cones);
  }
}

}  // namespace

const Effect effect::angular_profile{
    .name = "angular_profile",
    .group = EffectGroup::optics,
    .model = "soft: exp(-ln 2 (2a/D)^p); Airy: (2 J1(u) / u)^2, both 1/2 at D/2; a stack of flat cones",
    .error = ErrorKind::row_shape,
    .calls_for = calls_for,
    .bound = bound,
    .cost = [](const Circumstances& c) { return render_once_cost(c, static_cast<double>(stack_of(c).size()) - 1.0); },
    .apply = apply,
};

}  // namespace compueye::sim
