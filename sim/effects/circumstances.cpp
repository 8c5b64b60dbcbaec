#include "sim/effects/circumstances.hpp"

#include <algorithm>

namespace compueye::sim {

double EyeToSimulate::integration_s() const noexcept {
  return detector.integration_ms > 0.0 ? std::min(detector.integration_ms * 1e-3, period_s()) : period_s();
}

}  // namespace compueye::sim
