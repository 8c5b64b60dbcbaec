#include "calib/estimate/row_parameters.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::calib {
namespace {

/// Of a cubic B-spline with knots at the integers, one at 0.
double spline(double t) noexcept {
  t = std::abs(t);
  if (t >= 2.0) return 0.0;
  if (t >= 1.0) return 0.25 * (2.0 - t) * (2.0 - t) * (2.0 - t);
  return 1.0 + t * t * (0.75 * t - 1.5);
}

/// The halo reaches somewhat farther than the nearest neighbours' fields do.
constexpr double halo_neighbours = 1.25, least_halo = 1.05, most_halo = 1.4, halo_without_angle = 1.2;

double halo_half_rad(const hal::EyeGeometry& eye, double half_rad) noexcept {
  if (!(eye.interommatidial_rad > 0.0)) return half_rad * halo_without_angle;
  const double ratio = 1.0 + halo_neighbours * eye.interommatidial_rad / (eye.acceptance_rad / 2.0);
  return half_rad * std::clamp(ratio, least_halo, most_halo);
}

}  // namespace

SplinesAt splines_at(double px, double first_px, double pitch_px, int knots) noexcept {
  const double at = (px - first_px) / pitch_px;
  SplinesAt found;
  found.first = std::max(static_cast<int>(std::floor(at)) - 1, 0);
  const int end = std::min(static_cast<int>(std::floor(at)) + 3, knots);
  for (int knot = found.first; knot < end; ++knot) {
    found.value[static_cast<std::size_t>(found.count++)] = spline(at - knot);
  }
  return found;
}

double field_at(const std::vector<float>& field, const KnotGrid& grid, const SplinesAt& down,
                const SplinesAt& across) noexcept {
  double sum = 0.0;
  for (int u = 0; u < down.count; ++u) {
    const auto row = static_cast<std::size_t>((down.first + u) * grid.cols + across.first);
    double along = 0.0;
    for (int v = 0; v < across.count; ++v) {
      const auto knot = static_cast<std::size_t>(v);
      along += across.value[knot] * static_cast<double>(field[row + knot]);
    }
    sum += down.value[static_cast<std::size_t>(u)] * along;
  }
  return sum;
}

KnotGrid KnotGrid::over(const std::vector<std::int32_t>& support, int plane_cols, double pitch_px,
                        int most_knots) noexcept {
  const int top = support.front() / plane_cols, bottom = support.back() / plane_cols;
  int left = plane_cols, right = 0;
  for (const std::int32_t pixel : support) {
    left = std::min(left, pixel % plane_cols);
    right = std::max(right, pixel % plane_cols);
  }
  KnotGrid grid;
  grid.pitch_px = std::max(pitch_px, std::sqrt(static_cast<double>(support.size()) / most_knots));
  const auto knots = [&](int px) { return static_cast<int>(std::ceil(px / grid.pitch_px)) + 2; };
  grid.rows = knots(bottom - top);
  grid.cols = knots(right - left);
  // As far beyond one end as beyond the other.
  grid.first_row_px = 0.5 * (top + bottom) - 0.5 * (grid.rows - 1) * grid.pitch_px;
  grid.first_col_px = 0.5 * (left + right) - 0.5 * (grid.cols - 1) * grid.pitch_px;
  return grid;
}

RowSupport support_of(SoftCone& model, int i, int k, const ConeParameters& cone, const PlaneError& plane) {
  RowSupport support;
  model.expose(i, k, cone, plane, support.cone);
  ConeParameters wide = cone;
  wide.half_angle_rad = halo_half_rad(model.eye(), cone.half_angle_rad);
  ConeRow halo;
  model.expose(i, k, wide, plane, halo);
  support.pixels = std::move(halo.pixels);
  auto& [sensitivity, edge, around] = support.envelope;
  std::size_t next = 0;
  for (std::size_t j = 0; j < support.pixels.size(); ++j) {
    while (next < support.cone.size() && support.cone.pixels[next] < support.pixels[j]) ++next;
    const bool inside = next < support.cone.size() && support.cone.pixels[next] == support.pixels[j];
    support.in_cone.push_back(inside ? static_cast<std::int32_t>(next) : -1);
    sensitivity.push_back(inside ? cone.gain * support.cone.covered[next] : 0.0);
    edge.push_back(inside ? cone.gain * support.cone.change[2][next] : 0.0);
    around.push_back(cone.gain * halo.covered[j]);
  }
  return support;
}

std::vector<double> entries_of(const RowParameters& parameters, const RowSupport& support, int plane_cols) {
  const KnotGrid& grid = parameters.grid;
  std::vector<double> entries = support.envelope[0];
  for (std::size_t j = 0; j < entries.size(); ++j) {
    const SplinesAt down = splines_at(support.pixels[j] / plane_cols, grid.first_row_px, grid.pitch_px, grid.rows);
    const SplinesAt across = splines_at(support.pixels[j] % plane_cols, grid.first_col_px, grid.pitch_px, grid.cols);
    for (std::size_t f = 0; f < field_kinds; ++f) {
      if (parameters.field[f].empty()) continue;
      entries[j] += support.envelope[f][j] * field_at(parameters.field[f], grid, down, across);
    }
    entries[j] = std::max(entries[j], 0.0);
  }
  return entries;
}

}  // namespace compueye::calib
