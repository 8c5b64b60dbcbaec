#include "hal/eye_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "hal/field_range.hpp"

namespace compueye::hal {
namespace {

constexpr double deg = std::numbers::pi / 180.0;

constexpr std::array<std::pair<Lattice, std::string_view>, 5> lattice_names{{
    {Lattice::fisheye, "fisheye"},
    {Lattice::azimuth_elevation, "azimuth-elevation"},
    {Lattice::tangent, "tangent"},
    {Lattice::plane, "plane"},
    {Lattice::cylinder, "cylinder"},
}};

struct GridAngles {
  double a = 0.0, e = 0.0;
};

GridAngles grid_angles(const EyeGeometry& eye, int i, int k) {
  return {(k - (eye.columns - 1) / 2.0) * eye.interommatidial_rad,
          ((eye.rows - 1) / 2.0 - i) * eye.interommatidial_rad};
}

}  // namespace

std::string_view name(Lattice lattice) noexcept {
  for (const auto& [value, text] : lattice_names) {
    if (value == lattice) return text;
  }
  return "unknown";
}

Result<Lattice> lattice_from_name(std::string_view text) {
  std::string known;
  for (const auto& [value, known_name] : lattice_names) {
    if (known_name == text) return value;
    if (!known.empty()) known += ", ";
    known += known_name;
  }
  return fail(ErrorCode::not_found, "lattice", "'" + std::string(text) + "' is not one of " + known);
}

Vec3 EyeGeometry::axis(int i, int k) const noexcept {
  const auto [a, e] = grid_angles(*this, i, k);
  switch (lattice) {
    case Lattice::fisheye: {
      const double t = std::hypot(a, e);
      const double s = t > 0.0 ? std::sin(t) / t : 1.0;
      return {s * a, s * e, std::cos(t)};
    }
    case Lattice::azimuth_elevation:
      return {std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)};
    case Lattice::tangent: {
      const double u = std::tan(a), v = std::tan(e), n = std::hypot(u, v, 1.0);
      return {u / n, v / n, 1.0 / n};
    }
    case Lattice::plane:
      return {0.0, 0.0, 1.0};
    case Lattice::cylinder:
      return {std::sin(a), 0.0, std::cos(a)};
  }
  return {0.0, 0.0, 1.0};
}

Vec3 EyeGeometry::apex(int i, int k) const noexcept {
  const Vec3 d = axis(i, k);
  const double r = radius_mm + lens_height_mm;
  const double y = ((rows - 1) / 2.0 - i) * pitch_mm;
  if (lattice == Lattice::plane) return {(k - (columns - 1) / 2.0) * pitch_mm, y, r};
  if (lattice == Lattice::cylinder) return {r * d.x, y, r * d.z};
  return {r * d.x, r * d.y, r * d.z};
}

Result<void> EyeGeometry::validate() const {
  const bool flat = lattice == Lattice::plane;
  const bool pitched = flat || lattice == Lattice::cylinder;
  const double widest_deg = interommatidial_rad / deg * (std::max(rows, columns) - 1) / 2.0;
  return expect(rows >= 1 && rows <= 4096, "eye.rows", rows, "1 to 4096")
      .and_then([&] { return expect(columns >= 1 && columns <= 4096, "eye.columns", columns, "1 to 4096"); })
      .and_then([&] {
        return expect(flat || (interommatidial_rad > 0.0 && interommatidial_rad < 90.0 * deg),
                      "eye.interommatidial_angle_deg", interommatidial_rad / deg, "more than 0 and less than 90");
      })
      .and_then([&] {
        return expect(acceptance_rad > 0.0 && acceptance_rad <= 120.0 * deg * (1.0 + 1e-12), "eye.acceptance_angle_deg",
                      acceptance_rad / deg, "more than 0 and at most 120");
      })
      .and_then(
          [&] { return expect(std::isfinite(radius_mm) && radius_mm >= 0.0, "eye.radius_mm", radius_mm, "0 or more"); })
      .and_then([&] {
        return expect(std::isfinite(lens_height_mm) && lens_height_mm >= 0.0, "eye.lens_height_mm", lens_height_mm,
                      "0 or more");
      })
      .and_then([&] {
        return expect(!pitched || (std::isfinite(pitch_mm) && pitch_mm > 0.0), "eye.pitch_mm", pitch_mm,
                      "more than 0 for a plane or cylinder lattice");
      })
      .and_then([&] {
        return expect(lattice != Lattice::tangent || widest_deg < 90.0, "eye.interommatidial_angle_deg",
                      interommatidial_rad / deg, "a tangent lattice whose outermost ommatidium stays below 90 deg");
      });
}

Result<void> ObjectPlane::validate() const {
  return expect(rows >= 1 && rows <= 8192, "object.rows", rows, "1 to 8192")
      .and_then([&] { return expect(cols >= 1 && cols <= 8192, "object.columns", cols, "1 to 8192"); })
      .and_then(
          [&] { return expect(std::isfinite(width_mm) && width_mm > 0.0, "object.width_mm", width_mm, "more than 0"); })
      .and_then([&] {
        return expect(std::isfinite(height_mm) && height_mm > 0.0, "object.height_mm", height_mm, "more than 0");
      })
      .and_then([&] {
        return expect(std::isfinite(distance_mm) && distance_mm > 0.0, "object.distance_mm", distance_mm,
                      "more than 0");
      });
}

}  // namespace compueye::hal
