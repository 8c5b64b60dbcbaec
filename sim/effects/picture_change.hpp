#pragma once

#include "sim/effects/circumstances.hpp"

namespace compueye::sim {

/// Bound of what it changes when a surface's picture, as lit, changes by `change`, a number a pixel: rms over the
/// channels, LSB.
///
/// A channel's change is the integral of the picture's change over its look, squared at most the look's area times the
/// integral of the square (Cauchy and Schwarz); its mean over channels spread evenly over the picture is the square of
/// the area times the mean square of the change. Of the whole picture or of what lies on the object plane, whichever
/// is more; channels that look beside the surface count where nothing says that it stays there.
[[nodiscard]] double picture_change_lsb(const Circumstances& c, const Surface& surface, const hal::Image& change);

}  // namespace compueye::sim
