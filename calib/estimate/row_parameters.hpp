#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/estimate/soft_cone.hpp"

namespace compueye::calib {

/// Knots of smooth functions over a receptive field: products of cubic B-splines of one at their knot, row-major from
/// the upper left one, `pitch_px` apart. Beyond the knots the functions are nought.
struct KnotGrid {
  double pitch_px = 4.0;
  double first_row_px = 0.0, first_col_px = 0.0;  ///< of the first knot; 0 is the middle of pixel 0
  int rows = 0, cols = 0;

  [[nodiscard]] int knots() const noexcept { return rows * cols; }

  /// Over the box of a support that is not empty, on a plane of `cols` columns; the pitch grows where there would be
  /// more than `most_knots` over the support.
  [[nodiscard]] static KnotGrid over(const std::vector<std::int32_t>& support, int plane_cols, double pitch_px,
                                     int most_knots) noexcept;
};

/// The up to four splines along one axis that are not nought at a pixel.
struct SplinesAt {
  int first = 0;  ///< knot, from 0
  int count = 0;
  std::array<double, 4> value{};
};
[[nodiscard]] SplinesAt splines_at(double px, double first_px, double pitch_px, int knots) noexcept;

/// A knot each of `field`, at the pixel or between pixels whose splines these are.
[[nodiscard]] double field_at(const std::vector<float>& field, const KnotGrid& grid, const SplinesAt& down,
                              const SplinesAt& across) noexcept;

/// What the residual is made of.
enum class Field {
  sensitivity,  ///< multiplies the cone beside 1: dust, uneven sensitivity
  edge,         ///< moves the cone's edge out (ln half angle), where it is: coma, lenses that are not round
  halo,         ///< adds, over a cone as wide as the neighbours' reach: crosstalk, stray light
};
inline constexpr std::size_t field_kinds = 3;

/// Everything that makes one row of A: what is stored, and what is interpolated between distances.
struct RowParameters {
  ConeParameters cone;
  KnotGrid grid;                                      ///< shared by the three fields
  std::array<std::vector<float>, field_kinds> field;  ///< a knot each; empty: none
};

/// What the fields of a row are multiplied by, over its support.
struct RowSupport {
  ConeRow cone;                       ///< of the cone itself, over its own pixels
  std::vector<std::int32_t> pixels;   ///< ascending: those of the halo, or of the cone where that is off
  std::vector<std::int32_t> in_cone;  ///< a pixel: its place in `cone`, or -1
  std::array<std::vector<double>, field_kinds> envelope;  ///< a pixel, gain included
};

[[nodiscard]] RowSupport support_of(SoftCone& model, int i, int k, const ConeParameters& cone, const PlaneError& plane);

/// Entries that are not more than this are left out of a row.
inline constexpr double least_entry = 1e-3;

/// The entries over `support.pixels`: gain cone (1 + sensitivity) + edge d gain cone / d ln half angle + halo, at least
/// 0.
[[nodiscard]] std::vector<double> entries_of(const RowParameters& parameters, const RowSupport& support,
                                             int plane_cols);

}  // namespace compueye::calib
