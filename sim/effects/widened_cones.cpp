#include "sim/effects/widened_cones.hpp"

#include <vector>

#include "sim/effects/looks.hpp"

namespace compueye::sim {

double widened_share(const Circumstances& c, Widening widening) {
  const double half = c.board.eye.acceptance_rad / 2.0;
  return widening(c, half) / half - 1.0;
}

double widened_bound(const Circumstances& c, Widening widening) {
  const double half = widening(c, c.board.eye.acceptance_rad / 2.0);
  return widened_change_lsb(c, std::vector<double>(c.preview.levels.size(), half));
}

void widen_cones(const Circumstances& c, Workings& w, Widening widening) {
  for (OmmatidiumOptics& optics : w.optics.ommatidia) {
    for (ConeOfLight& cone : optics.cones) cone.half_angle_rad = widening(c, cone.half_angle_rad);
  }
}

}  // namespace compueye::sim
