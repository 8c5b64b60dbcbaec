#include "sim/render/shadow.hpp"

namespace compueye::sim {
namespace {

constexpr double tie = 1e-9;  // of the distance: what lies in one plane is told apart by its order

}  // namespace

Shadow::Shadow(const PlacedSurface& in_front, const hal::Vec3& apex, bool over) noexcept
    : ball_(in_front.shape == Shape::sphere) {
  const hal::Vec3 centre = in_front.centre - apex;
  const double distance = length(centre);
  if (!(distance > 0.0)) return;
  if (ball_) {
    const double sine = in_front.radius() / distance;
    if (!(sine < 1.0)) return;
    const hal::Vec3 axis = (1.0 / distance) * centre;
    const double cosine = std::sqrt(1.0 - sine * sine);
    of_ball_ = {{axis, sine, cosine}, {axis, -distance * cosine * cosine}, centre, in_front.radius()};
    any_ = true;
    return;
  }
  const double off = dot(in_front.away, centre);
  if (std::fabs(off) < 1e-12 * distance) return;  // edge-on
  const double side = off > 0.0 ? 1.0 : -1.0;
  const auto corners = in_front.corners();
  for (std::size_t k = 0; k < 4; ++k) {
    const hal::Vec3 normal = cross(corners[k] - apex, corners[(k + 1) % 4] - apex);
    rectangle_.sides[k] = {(side / length(normal)) * normal, 0.0};
  }
  rectangle_.sides[4] = {side * in_front.away, -side * off + (over ? tie : -tie) * distance};
  any_ = true;
}

bool Shadow::falls_on(const PlacedSurface& behind, const hal::Vec3& apex) noexcept {
  if (!any_) return false;
  const hal::Vec3 centre = behind.centre - apex;
  if (ball_) return of_ball_.margin(centre) > -behind.reach;
  const auto corners = behind.corners();
  for (std::size_t k = 0; k < rectangle_.sides.size(); ++k) {
    double lo = rectangle_.sides[k].margin(centre) - behind.reach, hi = lo + 2.0 * behind.reach;
    if (behind.shape == Shape::plane) {
      lo = hi = rectangle_.sides[k].margin(corners[0] - apex);
      for (const hal::Vec3& corner : corners) {
        const double margin = rectangle_.sides[k].margin(corner - apex);
        lo = std::min(lo, margin);
        hi = std::max(hi, margin);
      }
    }
    if (hi <= 0.0) return false;
    asked_[k] = lo < 0.0;
  }
  return true;
}

void Shadow::append_inside(std::vector<Constraint>& constraints) const {
  if (ball_) {
    constraints.emplace_back(of_ball_, true);
    return;
  }
  for (std::size_t k = 0; k < rectangle_.sides.size(); ++k) {
    if (asked_[k]) constraints.emplace_back(rectangle_.sides[k]);
  }
}

void Shadow::append_outside(std::vector<Constraint>& constraints) const {
  if (ball_) {
    constraints.emplace_back(of_ball_, false);
  } else {
    constraints.emplace_back(rectangle_, false);
  }
}

bool may_see(const WithinCone& cone, const hal::Vec3& from_apex, double reach) noexcept {
  return cone.margin(from_apex) > -reach;
}

}  // namespace compueye::sim
