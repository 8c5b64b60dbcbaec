#pragma once

#include "sim/effects/circumstances.hpp"

namespace compueye::sim {

/// Bound of what it changes when a surface's picture, as lit, changes by `change`, a number a pixel: rms over the
/// channels, LSB.
///
/// What lies still on the object plane is looked at: the change at 96 places of each look, or at 576 of the surface,
/// which is exact for what is coarse and adds less than a tenth of the change's rms for what is finer. Of what moves or
/// stands in depth nobody knows what a look will hold: a channel's change, squared, is at most the look's area times
/// the integral of the square (Cauchy and Schwarz), whose mean over looks spread evenly is the area times the mean
/// square.
[[nodiscard]] double picture_change_lsb(const Circumstances& c, const Surface& surface, const hal::Image& change);

}  // namespace compueye::sim
