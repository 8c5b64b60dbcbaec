#pragma once

#include <vector>

#include "recon/problem/plan.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// The ADMM penalty rho of a plan: plan.rho when given; lambda for tikhonov; pdhg has a rule of its own; otherwise by
/// rule, from A alone (but for loud rows, see below).
///
///   orthonormal bases:  rho = .06 ||A||_F^2 / N,           a share of the mean squared norm of A's columns
///   total variation:    rho = .1 ||A||_F ||A D'||_F / N,   D the forward differences of a picture's pixels
///
/// The best rho follows the curvature of the data term, not lambda, so one factor serves every lambda and noise level.
/// The first share was found on the 8x8 eye (pixels, 30 to 50 dB) and the 80x80 eye (DCT and box, 58 dB): a tenth or
/// ten times of it costs two to five times the iterations.
///
/// The step of total variation weighs differences, to which a wide field is nearly blind: its curvature there is that
/// of the field's edge, ||A D'||_F^2 / N. What converges best lies between that and the first rule, and their geometric
/// mean is at most a factor of three from the best of every eye tried. On the 80x80 eye it gives 6.9 where the first
/// rule gives 20: after 60 iterations at sigma .1 the phantom has half the NMSE of rho 20, at sigma .3 three quarters.
/// The objective alone would rather have 20 at sigma .3 and 4 at sigma .05. On the 8x8 eyes both rules agree.
///
/// All scale as A^2 does, and not with the unit of x. Where single rows are far louder than the others (row_norms.hpp)
/// rho is 4 lambda over white, but within what the rule says of the bulk of the rows and of all: with a lambda of the
/// loud row's size only the latter converges, with one of the others' only the former.
[[nodiscard]] double resolve_rho(const Response& response, const Objective& objective, const Plan& plan);

/// The first of the rules.
[[nodiscard]] double rho_by_columns(const Response& response);

/// What a core::PenaltySchedule is made of: the penalties that the iterations of a frame go through, around the rule's
/// rho. Frames with a weight other than one stay at rho, for which alone a cached factor is made.
struct PenaltyLevels {
  std::vector<double> penalties;
  int iterations_a_level = 1;
};

/// Those of the plan's solver (recon/setup/solvers); a rho that was asked for stays (one level). `plan` has its rho,
/// asked for or by rule, and its rank, if it has one; `order` is the number of seeing rows.
[[nodiscard]] PenaltyLevels penalty_levels(const Objective& objective, const Plan& plan, bool rho_by_rule, int order,
                                           bool mirror_symmetric);

/// Appends `count` values after `from` that end with `to`, each the same factor from the one before.
void push_geometric(double from, double to, int count, std::vector<double>& values);

}  // namespace compueye::recon
