#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/eye_geometry.hpp"

namespace compueye::calib {

/// What of one ommatidium is fitted. At an angle a from its axis its sensitivity is gain exp(-ln 2 (a /
/// half_angle)^order): half at the half angle, and the flat top of the drawing at a large order.
struct ConeParameters {
  double tilt_one_rad = 0.0;    ///< of the axis from the drawn one, about two directions across it
  double tilt_other_rad = 0.0;  ///< the other of the two
  double half_angle_rad = 0.0;
  double order = 8.0;
  double gain = 1.0;
};

/// Where the display stands beside where the drawing has it.
struct PlaneError {
  double distance_mm = 0.0;  ///< farther than drawn
  double lean_rad = 0.0;     ///< about the x axis through its centre; > 0: the upper edge is farther
  double tilt_rad = 0.0;     ///< about the y axis through its centre; > 0: the right edge is farther
};

/// What a soft cone of gain one covers of each pixel, and how that changes with its parameters.
struct ConeRow {
  static constexpr std::size_t changes = 4;  ///< by tilt_one, tilt_other, ln half_angle, ln order

  std::vector<std::int32_t> pixels;                 ///< ascending
  std::vector<double> covered;                      ///< a pixel, 0 .. 1
  std::array<std::vector<double>, changes> change;  ///< a pixel, per radian or per unit of the logarithm

  [[nodiscard]] std::size_t size() const noexcept { return pixels.size(); }
  void clear() noexcept;
};

/// The forward model of the fits. The profile is a stack of flat cones; across a pixel (or a part of one, where the
/// field is but a few pixels wide) the angle is taken for linear, with the mean of its curvature, so that the share of
/// the pixel within a cone is the area of a square below a line. That is one look at each pixel for all cones and all
/// derivatives, a hundred times quicker than their exact sections (pixel_coverage.hpp) and within 0.2 % of them.
/// Independent of the simulator's integrals. Not for two threads at once.
class SoftCone {
 public:
  /// `eye` and `plane` valid.
  SoftCone(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane);

  /// Of ommatidium (i, k); pixels that see less than a millionth are left out.
  void expose(int i, int k, const ConeParameters& parameters, const PlaneError& plane, ConeRow& row);

  /// What the drawing has, with the edge of a lens that is neither hard nor blurred.
  [[nodiscard]] ConeParameters drawn() const noexcept;

  [[nodiscard]] const hal::EyeGeometry& eye() const noexcept { return eye_; }
  [[nodiscard]] const hal::ObjectPlane& plane() const noexcept { return plane_; }

 private:
  /// An ommatidium in the coordinates of the display, and how its axis moves.
  struct Place {
    hal::Vec3 apex, axis, by_one, by_other;
    double z_mm = 0.0;
  };
  /// Rows and columns of a grid that divides each pixel into `parts` x `parts`; ends exclusive.
  struct Window {
    int first_row = 0, end_row = 0, first_col = 0, end_col = 0, parts = 1;
  };
  struct Shell {
    double half_rad, weight, by_order;  ///< the last: d half_rad / d ln order
  };
  /// Of one part of a pixel: covered, and its change by the angle, ln half angle and ln order.
  struct Cover {
    double covered = 0.0, by_angle = 0.0, by_half = 0.0, by_order = 0.0;
  };

  [[nodiscard]] Place placed(int i, int k, const ConeParameters& parameters, const PlaneError& plane) const noexcept;
  void stack(const ConeParameters& parameters) noexcept;
  [[nodiscard]] Window window_of(const Place& at) const noexcept;
  void measure_angles(const Place& at, const Window& window);
  [[nodiscard]] Cover cover(double angle, double across_x, double across_y) const noexcept;
  void add_part(const Place& at, const Window& window, int row, int col);

  hal::EyeGeometry eye_;
  hal::ObjectPlane plane_;
  std::array<Shell, 64> shells_{};                              // widest first
  std::array<Cover, 65> covered_within_{};                      // sums over the widest k shells, wholly covering
  std::vector<double> angles_;                                  // of the window and a border of one
  std::array<std::vector<double>, ConeRow::changes + 1> sums_;  // over all pixels, zero between rows
};

}  // namespace compueye::calib
