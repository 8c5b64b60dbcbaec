#include "calib/estimate/soft_cone.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/cone_section.hpp"

namespace compueye::calib {
namespace {

using hal::Vec3;

constexpr double widest_half_rad = 85.0 * std::numbers::pi / 180.0;
constexpr double least_covered = 1e-6;
constexpr double least_sine = 1e-9;
/// Of a field that is narrower, the parts of a pixel are looked at: edges bend too much across a whole one.
constexpr double least_radius_px = 3.0;
constexpr int most_parts = 8;

Vec3 less_along(const Vec3& v, const Vec3& unit) noexcept {
  const double along = dot(v, unit);
  return {v.x - along * unit.x, v.y - along * unit.y, v.z - along * unit.z};
}

/// Into the coordinates of a display that is turned: what is before it turns the other way.
Vec3 turned_back(const Vec3& v, const PlaneError& plane) noexcept {
  const double cx = std::cos(plane.lean_rad), sx = std::sin(plane.lean_rad);
  const double cy = std::cos(plane.tilt_rad), sy = std::sin(plane.tilt_rad);
  const Vec3 about_y{cy * v.x + sy * v.z, v.y, -sy * v.x + cy * v.z};
  return {about_y.x, cx * about_y.y + sx * about_y.z, -sx * about_y.y + cx * about_y.z};
}

/// The area of a square of side one about the origin where a x + b y < t, and its derivative by t; a >= b >= 0, a > 0.
struct Below {
  double area, slope;
};
Below below(double t, double a, double b) noexcept {
  const double corner = 0.5 * (a + b), shoulder = 0.5 * (a - b);
  const double u = std::abs(t);
  if (u >= corner) return {t > 0.0 ? 1.0 : 0.0, 0.0};
  Below found{0.0, 0.0};
  if (u <= shoulder) {
    found = {0.5 + u / a, 1.0 / a};
  } else {
    const double rest = corner - u;
    found = {1.0 - 0.5 * rest * rest / (a * b), rest / (a * b)};
  }
  if (t < 0.0) found.area = 1.0 - found.area;
  return found;
}

}  // namespace

void ConeRow::clear() noexcept {
  pixels.clear();
  covered.clear();
  for (auto& each : change) each.clear();
}

SoftCone::SoftCone(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane) : eye_(eye), plane_(plane) {
  for (auto& sums : sums_) sums.assign(static_cast<std::size_t>(plane.pixels()), 0.0);
}

ConeParameters SoftCone::drawn() const noexcept {
  ConeParameters parameters;
  parameters.half_angle_rad = eye_.acceptance_rad / 2.0;
  return parameters;
}

SoftCone::Place SoftCone::placed(int i, int k, const ConeParameters& parameters,
                                 const PlaneError& plane) const noexcept {
  const Vec3 drawn = eye_.axis(i, k);
  const Vec3 up = std::abs(drawn.y) < 0.7 ? Vec3{0.0, 1.0, 0.0} : Vec3{1.0, 0.0, 0.0};
  const Vec3 one = unit(cross(up, drawn)), other = cross(drawn, one);
  const double a = parameters.tilt_one_rad, b = parameters.tilt_other_rad;
  const Vec3 leaning{drawn.x + a * one.x + b * other.x, drawn.y + a * one.y + b * other.y,
                     drawn.z + a * one.z + b * other.z};
  const double length = std::sqrt(dot(leaning, leaning));
  Place at;
  at.z_mm = plane_.z_mm(eye_) + plane.distance_mm;
  const Vec3 apex = eye_.apex(i, k);
  at.apex = turned_back({apex.x, apex.y, apex.z - at.z_mm}, plane);
  at.apex.z += at.z_mm;
  at.axis = turned_back(unit(leaning), plane);
  const auto moves = [&](const Vec3& v) {
    const Vec3 move = less_along(turned_back(v, plane), at.axis);
    return Vec3{move.x / length, move.y / length, move.z / length};
  };
  at.by_one = moves(one);
  at.by_other = moves(other);
  return at;
}

// The picture seen by f is the mean over heights 0 < f < 1 of what the flat cone out to f sees. Nodes crowd at both
// ends, where the angle changes quickly with the height.
void SoftCone::stack(const ConeParameters& parameters) noexcept {
  const auto count = static_cast<double>(shells_.size());
  Cover sum;
  for (std::size_t c = 0; c < shells_.size(); ++c) {
    const double s = (static_cast<double>(c) + 0.5) / count;
    const double height = s * s * (3.0 - 2.0 * s);
    const double exponent = std::log(-std::log2(height)) / parameters.order;
    const double half = std::min(parameters.half_angle_rad * std::exp(exponent), widest_half_rad);
    shells_[c] = {half, 6.0 * s * (1.0 - s) / count, -exponent * half};
    sum.covered += shells_[c].weight;
    covered_within_[c + 1] = sum;
  }
}

SoftCone::Window SoftCone::window_of(const Place& at) const noexcept {
  const ConeSection outer(at.apex, at.axis, shells_.front().half_rad, at.z_mm);
  Window window;
  if (outer.empty()) return window;
  const double width = plane_.pixel_width_mm(), height = plane_.pixel_height_mm();
  const double radius_mm = (at.z_mm - at.apex.z) * std::tan(shells_[shells_.size() / 2].half_rad);
  window.parts = static_cast<int>(
      std::clamp(std::ceil(least_radius_px * std::max(width, height) / radius_mm), 1.0, double{most_parts}));
  // In columns and rows from the upper left corner, held within the display before they become integers.
  const auto within = [](double lo, double hi, int pixels) {
    return std::array<int, 2>{static_cast<int>(std::clamp(std::floor(lo), 0.0, double(pixels))),
                              static_cast<int>(std::clamp(std::ceil(hi), 0.0, double(pixels)))};
  };
  const auto cols = within((outer.vertex_x_mm() + outer.x_extent().lo + plane_.width_mm / 2.0) / width,
                           (outer.vertex_x_mm() + outer.x_extent().hi + plane_.width_mm / 2.0) / width, plane_.cols);
  const auto rows = within((plane_.height_mm / 2.0 - outer.vertex_y_mm() - outer.y_extent().hi) / height,
                           (plane_.height_mm / 2.0 - outer.vertex_y_mm() - outer.y_extent().lo) / height, plane_.rows);
  window.first_col = cols[0] * window.parts;
  window.end_col = cols[1] * window.parts;
  window.first_row = rows[0] * window.parts;
  window.end_row = rows[1] * window.parts;
  return window;
}

void SoftCone::measure_angles(const Place& at, const Window& window) {
  const double width = plane_.pixel_width_mm() / window.parts, height = plane_.pixel_height_mm() / window.parts;
  const double dz = at.z_mm - at.apex.z;
  angles_.clear();
  for (int r = window.first_row - 1; r <= window.end_row; ++r) {
    const double dy = plane_.height_mm / 2.0 - (r + 0.5) * height - at.apex.y;
    for (int c = window.first_col - 1; c <= window.end_col; ++c) {
      const double dx = (c + 0.5) * width - plane_.width_mm / 2.0 - at.apex.x;
      const double along = dx * at.axis.x + dy * at.axis.y + dz * at.axis.z;
      const double square = dx * dx + dy * dy + dz * dz;
      angles_.push_back(std::atan2(std::sqrt(std::max(square - along * along, 0.0)), along));
    }
  }
}

SoftCone::Cover SoftCone::cover(double angle, double across_x, double across_y) const noexcept {
  const double a = std::max({across_x, across_y, 1e-12}), b = std::max(std::min(across_x, across_y), 1e-9 * a);
  const double reach = 0.5 * (a + b);
  const auto wholly = std::partition_point(shells_.begin(), shells_.end(),
                                           [&](const Shell& shell) { return shell.half_rad >= angle + reach; });
  Cover sum = covered_within_[static_cast<std::size_t>(wholly - shells_.begin())];
  for (auto shell = wholly; shell != shells_.end() && shell->half_rad > angle - reach; ++shell) {
    const Below part = below(shell->half_rad - angle, a, b);
    const double slope = shell->weight * part.slope;
    sum.covered += shell->weight * part.area;
    sum.by_angle -= slope;
    sum.by_half += slope * shell->half_rad;
    sum.by_order += slope * shell->by_order;
  }
  return sum;
}

void SoftCone::add_part(const Place& at, const Window& window, int row, int col) {
  const auto wide = static_cast<std::ptrdiff_t>(window.end_col - window.first_col + 2);
  const double* angle = angles_.data() + (row - window.first_row + 1) * wide + (col - window.first_col + 1);
  const double left = angle[-1], right = angle[1], above = angle[-wide], under = angle[wide];
  const double bent = (left + right + above + under - 4.0 * *angle) / 24.0;
  const Cover part = cover(*angle + bent, 0.5 * std::abs(right - left), 0.5 * std::abs(above - under));
  if (part.covered <= 0.0) return;
  const auto n = static_cast<std::size_t>(row / window.parts * plane_.cols + col / window.parts);
  const double share = 1.0 / (window.parts * window.parts);
  sums_[0][n] += share * part.covered;
  if (part.by_angle == 0.0) return;
  const Vec3 ray =
      hal::unit({(col + 0.5) * plane_.pixel_width_mm() / window.parts - plane_.width_mm / 2.0 - at.apex.x,
                 plane_.height_mm / 2.0 - (row + 0.5) * plane_.pixel_height_mm() / window.parts - at.apex.y,
                 at.z_mm - at.apex.z});
  const double sine = std::max(std::sin(*angle), least_sine);
  sums_[1][n] -= share * part.by_angle * dot(ray, at.by_one) / sine;
  sums_[2][n] -= share * part.by_angle * dot(ray, at.by_other) / sine;
  sums_[3][n] += share * part.by_half;
  sums_[4][n] += share * part.by_order;
}

void SoftCone::expose(int i, int k, const ConeParameters& parameters, const PlaneError& plane, ConeRow& row) {
  row.clear();
  const Place at = placed(i, k, parameters, plane);
  stack(parameters);
  const Window window = window_of(at);
  if (window.first_row >= window.end_row || window.first_col >= window.end_col) return;
  measure_angles(at, window);
  for (int r = window.first_row; r < window.end_row; ++r) {
    for (int c = window.first_col; c < window.end_col; ++c) add_part(at, window, r, c);
  }
  for (int r = window.first_row / window.parts; r < window.end_row / window.parts; ++r) {
    for (int c = window.first_col / window.parts; c < window.end_col / window.parts; ++c) {
      const auto n = static_cast<std::size_t>(r * plane_.cols + c);
      if (sums_[0][n] >= least_covered) {
        row.pixels.push_back(static_cast<std::int32_t>(n));
        row.covered.push_back(sums_[0][n]);
        for (std::size_t d = 0; d < ConeRow::changes; ++d) row.change[d].push_back(sums_[d + 1][n]);
      }
      for (auto& sums : sums_) sums[n] = 0.0;
    }
  }
}

}  // namespace compueye::calib
