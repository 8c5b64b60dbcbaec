#include "sim/effects/levels_before.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::sim {

// Shares of all levels add up at most. What one channel has for itself has no sign in common with another effect's, so
// squares add up; what shifts all channels by one level makes no difference between them.
LevelsBefore levels_before(const Effect& effect, const Circumstances& c) {
  LevelsBefore before;
  double squares = 0.0;
  for (const Effect* each : effects()) {
    if (each == &effect) break;
    if (each->error == ErrorKind::offset || each->calls_for(c).empty()) continue;
    const double bound = each->bound_in_levels != nullptr ? each->bound_in_levels(c) : each->bound(c);
    if (each->error == ErrorKind::common_gain) {
      before.brighter += bound / std::max(c.preview.rms, 1e-12);
    } else {
      squares += bound * bound;
    }
  }
  before.uneven_lsb = std::sqrt(squares);
  return before;
}

}  // namespace compueye::sim
