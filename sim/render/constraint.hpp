#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "hal/vec3.hpp"

namespace compueye::sim {

/// One condition on where light comes from, on the vector d from the apex to the point that shines. `margin(d)` is
/// positive where it holds, and changes by no more than d does (mm), so that a margin larger than a piece's radius
/// decides for all of the piece.
struct HalfSpace {
  hal::Vec3 normal;  ///< unit
  double offset = 0.0;
  [[nodiscard]] double margin(const hal::Vec3& d) const noexcept { return dot(normal, d) + offset; }
};

/// Within a half angle of an axis: the distance from the cone's mantle.
struct WithinCone {
  hal::Vec3 axis;  ///< unit
  double sine = 0.0, cosine = 1.0;
  [[nodiscard]] double margin(const hal::Vec3& d) const noexcept {
    const double along = dot(axis, d);
    return sine * along - cosine * std::sqrt(std::max(0.0, dot(d, d) - along * along));
  }
};

/// What a rectangle hides: the pyramid from the apex through its edges, from its plane on.
struct RectangleShadow {
  std::array<HalfSpace, 5> sides;
  [[nodiscard]] double margin(const hal::Vec3& d) const noexcept {
    double least = sides[0].margin(d);
    for (std::size_t k = 1; k < sides.size(); ++k) least = std::min(least, sides[k].margin(d));
    return least;
  }
  /// Of the sides in `open` alone, one bit each.
  [[nodiscard]] double margin(const hal::Vec3& d, unsigned open) const noexcept {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < sides.size(); ++k) {
      if ((open >> k & 1U) != 0) least = std::min(least, sides[k].margin(d));
    }
    return least;
  }
  /// Sides that do not hold all over a piece.
  [[nodiscard]] unsigned open(const hal::Vec3& d, double radius) const noexcept {
    unsigned bits = 0;
    for (std::size_t k = 0; k < sides.size(); ++k) bits |= sides[k].margin(d) < radius ? 1U << k : 0U;
    return bits;
  }
};

/// What a ball hides: its inside, and the cone that touches it from where it touches on.
struct BallShadow {
  WithinCone cone;
  HalfSpace beyond;
  hal::Vec3 centre;
  double radius = 0.0;
  [[nodiscard]] double margin(const hal::Vec3& d) const noexcept {
    return std::max(std::min(cone.margin(d), beyond.margin(d)), radius - length(d - centre));
  }
  /// 1: all of a piece is beyond where the cone touches, and the ball within the cone there. Else 3.
  [[nodiscard]] unsigned open(const hal::Vec3& d, double piece) const noexcept {
    return beyond.margin(d) >= piece ? 1U : 3U;
  }
  [[nodiscard]] double margin(const hal::Vec3& d, unsigned open) const noexcept {
    return open == 1U ? cone.margin(d) : margin(d);
  }
};

struct Constraint {
  enum class Kind { half_space, cone, rectangle, not_rectangle, ball, not_ball, not_by_itself };
  Kind kind = Kind::half_space;
  union {
    HalfSpace half_space;
    WithinCone cone;
    RectangleShadow rectangle;
    BallShadow ball;
  };

  Constraint() noexcept : half_space{} {}
  /// Of a relief: the point is not hidden by the relief itself, which is the surface's to say.
  [[nodiscard]] static Constraint not_hidden_by_itself() noexcept {
    Constraint constraint;
    constraint.kind = Kind::not_by_itself;
    return constraint;
  }
  explicit Constraint(const HalfSpace& h) noexcept : half_space(h) {}
  explicit Constraint(const WithinCone& c) noexcept : kind(Kind::cone), cone(c) {}
  Constraint(const RectangleShadow& r, bool hidden) noexcept
      : kind(hidden ? Kind::rectangle : Kind::not_rectangle), rectangle(r) {}
  Constraint(const BallShadow& b, bool hidden) noexcept : kind(hidden ? Kind::ball : Kind::not_ball), ball(b) {}

  [[nodiscard]] double margin(const hal::Vec3& d) const noexcept {
    switch (kind) {
      case Kind::half_space:
        return half_space.margin(d);
      case Kind::cone:
        return cone.margin(d);
      case Kind::rectangle:
        return rectangle.margin(d);
      case Kind::not_rectangle:
        return -rectangle.margin(d);
      case Kind::ball:
        return ball.margin(d);
      case Kind::not_ball:
        return -ball.margin(d);
      case Kind::not_by_itself:
        return 0.0;
    }
    return 0.0;
  }
  /// The conditions that a piece of this radius about d does not decide, one bit each; all others hold all over it. An
  /// edge that only one of them makes has no corner.
  [[nodiscard]] unsigned open(const hal::Vec3& d, double radius) const noexcept {
    switch (kind) {
      case Kind::rectangle:
      case Kind::not_rectangle:
        return rectangle.open(d, radius);
      case Kind::ball:
      case Kind::not_ball:
        return ball.open(d, radius);
      default:
        return 1U;
    }
  }
  /// Has the sign of `margin(d)` within the piece that left `open`.
  [[nodiscard]] double margin(const hal::Vec3& d, unsigned open) const noexcept {
    switch (kind) {
      case Kind::rectangle:
        return rectangle.margin(d, open);
      case Kind::not_rectangle:
        return -rectangle.margin(d, open);
      case Kind::ball:
        return ball.margin(d, open);
      case Kind::not_ball:
        return -ball.margin(d, open);
      default:
        return margin(d);
    }
  }
  [[nodiscard]] static bool one_edge(unsigned open) noexcept { return std::popcount(open) == 1; }
  /// That edge is linear in d.
  [[nodiscard]] bool linear() const noexcept {
    return kind == Kind::half_space || kind == Kind::rectangle || kind == Kind::not_rectangle;
  }
};

}  // namespace compueye::sim
