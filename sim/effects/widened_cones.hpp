#pragma once

#include "sim/effects/circumstances.hpp"
#include "sim/effects/workings.hpp"

namespace compueye::sim {

/// The half angle from which light comes in, of one drawn as `half_rad`; rad, at most widest_half_rad if it is wider.
using Widening = double (*)(const Circumstances& c, double half_rad);

/// By how much the acceptance angle widens, relative; 0 or less: not at all.
[[nodiscard]] double widened_share(const Circumstances& c, Widening widening);

/// Bound of what that changes, LSB: widened_change_lsb, all ommatidia alike.
[[nodiscard]] double widened_bound(const Circumstances& c, Widening widening);

/// Does it to every cone of every ommatidium.
void widen_cones(const Circumstances& c, Workings& w, Widening widening);

}  // namespace compueye::sim
