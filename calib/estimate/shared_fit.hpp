#pragma once

#include <span>

#include "calib/estimate/cone_fit.hpp"

namespace compueye::calib {

/// What all rows share: where the display stands and what it makes of a pattern.
struct SharedParameters {
  PlaneError plane;
  DisplayResponse display;
};

struct SharedFit {
  SharedParameters value;
  SharedParameters sigma;  ///< standard deviations; those of what is not fitted are 0
  int passes = 0;
};

struct SharedFitSettings {
  bool plane = true;    ///< distance and the two turns
  bool display = true;  ///< black level, and gamma where patterns have greys
};

/// Gauss-Newton over a sample of channels, each with a cone of its own that is eliminated (Schur complement). A plane
/// that is farther and acceptance angles that are wider look the same; what tells them apart is that poses scatter
/// about the drawing: their spread is taken from the fitted cones, and no such thing is said of angles.
[[nodiscard]] SharedFit fit_shared(SoftCone& model, std::span<const int> channels, const Captures& captures,
                                   const LightSamples& samples, const ConePrior& prior,
                                   const SharedFitSettings& settings);

}  // namespace compueye::calib
