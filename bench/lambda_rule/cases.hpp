#pragma once

#include <string>
#include <vector>

#include "hal/eye_geometry.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::bench {

/// An eye, how its response is known, and what it is asked to solve.
struct Case {
  std::string name;
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  bool measured = false;  ///< a plausible measured response, with y = A x exactly, in place of the drawn one
  bool exact = false;     ///< y = A x exactly for a drawn response too
  recon::BasisKind basis = recon::BasisKind::identity;
  recon::ConstraintKind constraint = recon::ConstraintKind::box;
  int iterations = 0;
  std::vector<std::string> scenes;  ///< that suit the basis
  std::vector<double> tuning_sigmas, evaluation_sigmas;
  int seeds = 1;                       ///< pictures of each scene at each sigma
  double grid_step = 2.0;              ///< between lambdas of the sweep
  int grid_below = 0, grid_above = 0;  ///< steps under and over the rule's lambda
  bool large = false;
};

/// Every eye with every basis, drawn and measured.
[[nodiscard]] std::vector<Case> lambda_cases();

/// Every eye with every basis, drawn and measured, in the box and free; sigmas are signal-to-noise ratios in dB there.
[[nodiscard]] std::vector<Case> family_cases();

/// The 80x80 eye as the paper's figures have it: y = A x exactly, sigma^2 = .1, seed 0.
[[nodiscard]] std::vector<Case> paper_cases();

}  // namespace compueye::bench
