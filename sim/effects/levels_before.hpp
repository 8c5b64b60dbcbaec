#pragma once

#include "sim/effects/effect.hpp"

namespace compueye::sim {

/// How the levels that reach an effect may differ from the preview's, by the bounds of all that is called for and comes
/// before it in the list.
struct LevelsBefore {
  double brighter = 1.0;    ///< all of them, at most so many times
  double uneven_lsb = 0.0;  ///< rms over the channels of what each has for itself: dust, gains, hot channels
};

[[nodiscard]] LevelsBefore levels_before(const Effect& effect, const Circumstances& c);

}  // namespace compueye::sim
