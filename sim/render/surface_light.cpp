#include "sim/render/surface_light.hpp"

#include <algorithm>
#include <cmath>

#include "sim/render/cell_integral.hpp"
#include "sim/render/flat_section.hpp"

namespace compueye::sim {
namespace {

WithinCone within(const ConeOfLight& cone) {
  return {cone.axis, std::sin(cone.half_angle_rad), std::cos(cone.half_angle_rad)};
}

/// A picture with blurred edges is a little larger than its surface.
double reach_of(const PictureSums& picture, const PlacedSurface& place) {
  return std::max(place.reach, std::hypot(picture.left_mm(), picture.top_mm()));
}

/// Of a ball only what is before where the rays touch it.
void append_front(const PlacedSurface& place, const hal::Vec3& apex, std::vector<Constraint>& constraints) {
  if (place.shape != Shape::sphere) return;
  const hal::Vec3 centre = place.centre - apex;
  const double distance = length(centre);
  const double touching = distance - place.radius() * place.radius() / distance;
  constraints.emplace_back(HalfSpace{(-1.0 / distance) * centre, touching});
}

template <class Map>
double integrate(const PictureSums& picture, const PlacedSurface& place, const Gaze& gaze,
                 std::vector<Constraint>& constraints) {
  const Map map(place, gaze.apex, gaze.weight);
  return map.seen() ? CellIntegral<Map>(picture, map, constraints, gaze.tolerance).value() : 0.0;
}

/// All that constraints leave of one place.
double constrained(const PictureSums& picture, const PlacedSurface& place, const Gaze& gaze,
                   std::vector<Constraint>& constraints) {
  if (place.shape == Shape::sphere) return integrate<BallMap>(picture, place, gaze, constraints);
  return integrate<PlaneMap>(picture, place, gaze, constraints);
}

double in_own_frame(const PictureSums& picture, const PlacedSurface& place, const Gaze& gaze, const ConeOfLight& cone) {
  const PlaneMap map(place, gaze.apex, gaze.weight);
  if (!map.seen()) return 0.0;
  const hal::Vec3 from = gaze.apex - place.centre;
  const hal::Vec3 apex{dot(from, place.right), dot(from, place.up), dot(from, place.away)};
  const hal::Vec3 axis{dot(cone.axis, place.right), dot(cone.axis, place.up), dot(cone.axis, place.away)};
  const double weight = map.weight(0.0, 0.0, map.at(0.0, 0.0));
  return weight * light_in_section(picture, apex, axis, cone.half_angle_rad, 1e-2 * gaze.tolerance / weight);
}

}  // namespace

double light_seen(const PictureSums& picture, const PlacedSurface& place, const Gaze& gaze, const ConeOfLight& cone,
                  std::vector<Constraint>& constraints) {
  const WithinCone inside = within(cone);
  if (!may_see(inside, place.centre - gaze.apex, reach_of(picture, place))) return 0.0;
  if (place.shape == Shape::plane && PlaneMap(place, gaze.apex, gaze.weight).even()) {
    return in_own_frame(picture, place, gaze, cone);
  }
  constraints.clear();
  constraints.emplace_back(inside);
  append_front(place, gaze.apex, constraints);
  return constrained(picture, place, gaze, constraints);
}

double light_hidden(const PictureSums& picture, const PlacedSurface& place, const Gaze& gaze, const ConeOfLight& cone,
                    std::span<const Shadow> shadows, std::size_t k, std::vector<Constraint>& constraints) {
  const WithinCone inside = within(cone);
  if (!may_see(inside, place.centre - gaze.apex, reach_of(picture, place))) return 0.0;
  constraints.clear();
  constraints.emplace_back(inside);
  append_front(place, gaze.apex, constraints);
  shadows[k].append_inside(constraints);
  for (std::size_t j = 0; j < k; ++j) shadows[j].append_outside(constraints);
  return constrained(picture, place, gaze, constraints);
}

}  // namespace compueye::sim
