#pragma once

#include <string_view>

#include "hal/result.hpp"
#include "hal/vec3.hpp"

namespace compueye::hal {

/// How the K x L grid of ommatidia maps to directions. With a = (k-(L-1)/2) dphi, e = ((K-1)/2-i) dphi:
enum class Lattice {
  fisheye,            ///< t = hypot(a,e): (sin t a/t, sin t e/t, cos t); the default
  azimuth_elevation,  ///< (cos e sin a, sin e, cos e cos a)
  tangent,            ///< (tan a, tan e, 1) normalised
  plane,              ///< all axes +z, apexes on a square grid of `pitch_mm` (TOMBO)
  cylinder,           ///< (sin a, 0, cos a), rows `pitch_mm` apart along y (CurvACE)
};

[[nodiscard]] std::string_view name(Lattice lattice) noexcept;
/// not_found names the known lattices.
[[nodiscard]] Result<Lattice> lattice_from_name(std::string_view text);

/// Where each ommatidium sits and looks. Eye frame: centre of the sphere at the origin, front +z, x right, y up;
/// lengths in mm, angles in radians. Ommatidium (i, k), row 0 on top, has index m = i * columns + k.
/// Source: Lee et al., "COMPU-EYE", Optics Express 24 (2016), with the apex at R + f so that distances are measured
/// from the lens tip.
struct EyeGeometry {
  Lattice lattice = Lattice::fisheye;
  int rows = 8;                      ///< K >= 1
  int columns = 8;                   ///< L >= 1
  double interommatidial_rad = 0.0;  ///< angle between neighbours; > 0 except for a plane
  double acceptance_rad = 0.0;       ///< full cone angle, 0 < acceptance <= 120 deg
  double radius_mm = 6.9216;         ///< R >= 0
  double lens_height_mm = 1.35;      ///< f >= 0
  double pitch_mm = 0.0;             ///< plane and cylinder only, > 0 there

  [[nodiscard]] int ommatidia() const noexcept { return rows * columns; }
  /// Unit axis of ommatidium (i, k).
  [[nodiscard]] Vec3 axis(int i, int k) const noexcept;
  /// Apex of its cone.
  [[nodiscard]] Vec3 apex(int i, int k) const noexcept;
  /// Error out_of_range names the field and its allowed range.
  [[nodiscard]] Result<void> validate() const;

  bool operator==(const EyeGeometry&) const = default;
};

/// The plane the eye looks at, perpendicular to z, centred on the axis. Pixel (r, c): row 0 on top, n = r * cols + c.
struct ObjectPlane {
  int rows = 16;              ///< N_v >= 1
  int cols = 16;              ///< N_u >= 1
  double width_mm = 8.0;      ///< > 0
  double height_mm = 8.0;     ///< > 0
  double distance_mm = 30.0;  ///< from the lens tip, > 0

  [[nodiscard]] int pixels() const noexcept { return rows * cols; }
  [[nodiscard]] double pixel_width_mm() const noexcept { return width_mm / cols; }
  [[nodiscard]] double pixel_height_mm() const noexcept { return height_mm / rows; }
  /// z of the plane in the eye frame: R + f + L.
  [[nodiscard]] double z_mm(const EyeGeometry& eye) const noexcept {
    return eye.radius_mm + eye.lens_height_mm + distance_mm;
  }
  [[nodiscard]] Result<void> validate() const;

  bool operator==(const ObjectPlane&) const = default;
};

}  // namespace compueye::hal
