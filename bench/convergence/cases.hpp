#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/convergence/trial.hpp"
#include "bench/eyes.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::bench {

/// A frame whose time is wanted, and what was hoped for it.
struct FrameCase {
  std::string name;
  Eye eye;
  Scenes scenes;
  bool measured = false;       ///< rows as a calibration might find them
  recon::Objective objective;  ///< lambda by rule
  recon::Plan plan;
  int most = 60;                 ///< iterations to look at
  bool mean_within_one = false;  ///< counts when the mean is within 1 % of converged, else mean and high within 5 %
  double asked_ms = 0.0;
  double aimed_ms = 0.0;
};

[[nodiscard]] std::vector<FrameCase> frame_cases();

}  // namespace compueye::bench
