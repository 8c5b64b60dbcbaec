#pragma once

#include <vector>

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// What a core::PenaltySchedule is made of.
struct PenaltyLevels {
  std::vector<double> penalties;
  int iterations_a_level = 1;
};

/// The penalties that the iterations of a frame go through, around the rule's `rho`; a rho that was asked for stays
/// (one level). Frames with a
/// weight other than one stay at rho, for which alone the cached factor is made.
///
/// admm in pixels, on a small eye: down from 4/3 rho to 1/3 within 16 iterations, and slowly back. The first
/// iterations find the lit pixels with small steps, the middle ones set their brightness with large ones: 22 to 24
/// iterations where the best constant penalty takes 77 (64/256, 30 dB).
///
/// pdhg in an orthonormal basis whose modes are not all known: up to twice rho within 16 iterations, unless lambda /
/// rho says that the frame is over by then: 26 iterations for 30 at 80x80, 22 for 34 at 120x120 (paper noise).
///
/// The same on an eye without mirror symmetry, whose rows were measured: down from 5/2 rho to 10/7 of it within 12
/// iterations, 20 iterations for 34 at 80x80.
///
/// `plan` has its rho, asked for or by rule, and its rank, if it has one; `order` is the number of seeing rows.
[[nodiscard]] PenaltyLevels penalty_levels(const Objective& objective, const Plan& plan, bool rho_by_rule, int order,
                                           bool mirror_symmetric);

}  // namespace compueye::recon
