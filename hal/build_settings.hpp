#pragma once

#include <cstdint>

#include "hal/result.hpp"

namespace compueye::hal {

/// How strongly an ommatidium takes in light at an angle a from its axis, D being its acceptance angle.
enum class ProfileKind {
  flat_top,  ///< 1 within D/2, else 0: Lee et al. (2016)
  soft,      ///< exp(-ln 2 (2a/D)^edge_order): half at D/2
  airy,      ///< (2 J1(u)/u)^2, half at D/2
};

/// How far an eye as built is from its drawing. Every value 0 (or flat_top): exactly as drawn. What is drawn at random
/// follows from `seed` alone: the same eye whatever scene stands before it.
struct BuildSettings {
  std::uint64_t seed = 1;
  double pose_rms_deg = 0.0;       ///< of an axis about each of its two directions, normal, 0 .. 10
  double apex_rms_mm = 0.0;        ///< of an apex along each of x, y, z, normal, 0 .. 1
  double acceptance_spread = 0.0;  ///< relative, normal, 0 .. 0.3
  ProfileKind profile = ProfileKind::flat_top;
  double edge_order = 8.0;        ///< soft alone: 1 .. 64; the larger, the nearer to a flat top
  double coma = 0.0;              ///< outer shells look aside by this share of D/2, away from the eye's front, 0 .. 0.5
  double lens_diameter_mm = 0.0;  ///< of an ommatidium; 0: so large that nothing is diffracted
  /// Before the photodiode, 1 .. 2.5. The board's acceptance angle is n times that inside; by Snell it is
  /// 2 asin(n sin(angle / 2n)).
  double refractive_index = 1.0;
  double dust_share = 0.0;         ///< of the ommatidia, 0 .. 1
  double dust_loss = 0.3;          ///< of the light of a dusty ommatidium, on one half of its view, 0 .. 1
  double crosstalk = 0.0;          ///< of a channel's signal that its four neighbours share, 0 .. 0.5
  double gain_spread = 0.0;        ///< PRNU, relative, normal, 0 .. 0.5
  double offset_spread_lsb = 0.0;  ///< DSNU, LSB, normal, 0 .. 4096
  double vignetting = 0.0;         ///< light of a ray at angle t from z falls as cos^vignetting t, 0 .. 8

  /// Error out_of_range names the field, its value and its range.
  [[nodiscard]] Result<void> validate() const;
};

}  // namespace compueye::hal
