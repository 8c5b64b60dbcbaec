#include "sim/render/optics_as_built.hpp"

namespace compueye::sim {

OpticsAsBuilt OpticsAsBuilt::drawn(const hal::EyeGeometry& eye) {
  OpticsAsBuilt optics;
  optics.ommatidia.reserve(static_cast<std::size_t>(eye.ommatidia()));
  for (int i = 0; i < eye.rows; ++i) {
    for (int k = 0; k < eye.columns; ++k) {
      optics.ommatidia.push_back({eye.apex(i, k), {{eye.axis(i, k), eye.acceptance_rad / 2.0, 1.0}}});
    }
  }
  return optics;
}

}  // namespace compueye::sim
