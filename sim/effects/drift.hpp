#pragma once

#include "sim/effects/effect.hpp"

namespace compueye::sim {

/// Of light that changes by a share of `per_hour` an hour, linearly in time: all levels by the same share, most at the
/// end of the time; over the time its rms is 1 / sqrt 3 of that.
[[nodiscard]] double drift_bound(const Circumstances& c, double per_hour) noexcept;

/// The largest factor of the levels in that time, >= 1.
[[nodiscard]] double largest_drift(const Circumstances& c, double per_hour) noexcept;

/// Levels times 1 + drift t, never less than nought.
void add_drift(Workings& w, double per_hour);

}  // namespace compueye::sim
