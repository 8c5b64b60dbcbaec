#pragma once

#include <vector>

#include "sim/render/constraint.hpp"
#include "sim/render/placed_surface.hpp"

namespace compueye::sim {

/// What a surface hides from an apex, as conditions that all hold in its shadow. A relief hides what its rectangle
/// does.
class Shadow {
 public:
  /// `over`: of two surfaces in one plane this one is on top.
  Shadow(const PlacedSurface& in_front, const hal::Vec3& apex, bool over) noexcept;

  /// Whether any of `behind` may lie in it. Conditions that hold all over `behind` are not asked for again.
  [[nodiscard]] bool falls_on(const PlacedSurface& behind, const hal::Vec3& apex) noexcept;

  void append_inside(std::vector<Constraint>& constraints) const;
  void append_outside(std::vector<Constraint>& constraints) const;

 private:
  bool any_ = false, ball_ = false;
  RectangleShadow rectangle_;
  BallShadow of_ball_;
  std::array<bool, 5> asked_{};
};

/// Whether anything within `reach` of a point may be inside the cone.
[[nodiscard]] bool may_see(const WithinCone& cone, const hal::Vec3& from_apex, double reach) noexcept;

}  // namespace compueye::sim
