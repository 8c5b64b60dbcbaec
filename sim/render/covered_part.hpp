#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/render/light_map.hpp"

namespace compueye::sim {

/// The part of a cell where a margin is positive.
struct CoveredPart {
  double area = 0.0;        ///< mm^2
  double x = 0.0, y = 0.0;  ///< its centroid
  bool known = false;       ///< false: the edge enters and leaves more than once
};

/// Margins at a cell's corners, counter-clockwise from the lower left, and at its middle.
struct CornerMargins {
  std::array<double, 4> corner;
  double middle;

  [[nodiscard]] int inside() const noexcept {
    int count = 0;
    for (const double g : corner) count += g > 0.0 ? 1 : 0;
    return count;
  }
  /// How far the margin is from linear over the cell, as a share of its range.
  [[nodiscard]] double bend() const noexcept {
    const double mean = 0.25 * (corner[0] + corner[1] + corner[2] + corner[3]);
    const double askew = 0.25 * (corner[0] - corner[1] + corner[2] - corner[3]);
    const double range =
        std::max({corner[0], corner[1], corner[2], corner[3]}) - std::min({corner[0], corner[1], corner[2], corner[3]});
    const double bent = std::max(std::fabs(middle - mean), std::fabs(askew));
    return bent == 0.0 ? 0.0 : bent / range;
  }
};

/// Cuts the cell by the edge: where it crosses the cell's sides by one step of inverse interpolation with `margin_at(x,
/// y)`, then the bulge over the chord between from the margin at its middle. `straight`: the edge is, no call is made.
template <class MarginAt>
[[nodiscard]] CoveredPart covered_part(const Cell& cell, const CornerMargins& margins, bool straight,
                                       const MarginAt& margin_at) {
  const double hw = 0.5 * cell.width, hh = 0.5 * cell.height;
  const std::array<std::array<double, 2>, 4> corners{{{-hw, -hh}, {hw, -hh}, {hw, hh}, {-hw, hh}}};
  std::array<std::array<double, 2>, 6> polygon{};
  std::array<std::array<double, 2>, 2> crossings{};
  std::size_t points = 0, crossed = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    const double a = margins.corner[k], b = margins.corner[next];
    if (a > 0.0) polygon[points++] = corners[k];
    if ((a > 0.0) == (b > 0.0)) continue;
    if (crossed == 2) return {};
    double t = a / (a - b);
    const auto at = [&](double share) {
      return std::array<double, 2>{corners[k][0] + share * (corners[next][0] - corners[k][0]),
                                   corners[k][1] + share * (corners[next][1] - corners[k][1])};
    };
    if (!straight && t > 1e-6 && t < 1.0 - 1e-6) {
      const auto guess = at(t);
      const double here = margin_at(cell.x + guess[0], cell.y + guess[1]);
      const double slope = (b - a) + here / (t * (t - 1.0)) * (2.0 * t - 1.0);
      const double better = t - here / slope;
      if (better > 0.0 && better < 1.0) t = better;
    }
    crossings[crossed++] = at(t);
    polygon[points++] = at(t);
  }
  if (crossed != 2) return {};

  double area = 0.0, mx = 0.0, my = 0.0;
  for (std::size_t k = 0; k < points; ++k) {
    const auto &p = polygon[k], &q = polygon[(k + 1) % points];
    const double twice = p[0] * q[1] - q[0] * p[1];
    area += 0.5 * twice;
    mx += twice * (p[0] + q[0]) / 6.0;
    my += twice * (p[1] + q[1]) / 6.0;
  }
  if (!straight) {
    const auto &p = crossings[0], &q = crossings[1];
    const double x = 0.5 * (p[0] + q[0]), y = 0.5 * (p[1] + q[1]);
    const double gx =
        0.5 * (margins.corner[1] + margins.corner[2] - margins.corner[0] - margins.corner[3]) / cell.width;
    const double gy =
        0.5 * (margins.corner[2] + margins.corner[3] - margins.corner[0] - margins.corner[1]) / cell.height;
    const double off = margin_at(cell.x + x, cell.y + y) / std::hypot(gx, gy);
    const double bulge = 2.0 / 3.0 * off * std::hypot(q[0] - p[0], q[1] - p[1]);
    if (std::isfinite(bulge)) {
      area += bulge;
      mx += bulge * x;
      my += bulge * y;
    }
  }
  if (!(area > 0.0)) return {0.0, cell.x, cell.y, true};
  return {area, cell.x + mx / area, cell.y + my / area, true};
}

}  // namespace compueye::sim
