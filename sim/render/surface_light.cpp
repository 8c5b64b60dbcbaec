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
double reach_of(const Sight& sight) {
  return std::max(sight.place.reach, std::hypot(sight.picture.left_mm(), sight.picture.top_mm()));
}

/// Of a ball only what is before where the rays touch it, of a relief what it does not hide itself.
void append_front(const Sight& sight, const hal::Vec3& apex, std::vector<Constraint>& constraints) {
  if (sight.hides_itself) constraints.push_back(Constraint::not_hidden_by_itself());
  if (sight.place.shape != Shape::sphere) return;
  const hal::Vec3 centre = sight.place.centre - apex;
  const double distance = length(centre);
  const double touching = distance - sight.place.radius() * sight.place.radius() / distance;
  constraints.emplace_back(HalfSpace{(-1.0 / distance) * centre, touching});
}

template <class Map>
double integrate(const Sight& sight, const Map& map, const Gaze& gaze, std::vector<Constraint>& constraints) {
  return map.seen() ? CellIntegral<Map>(sight.picture, map, constraints, gaze.tolerance).value() : 0.0;
}

double constrained(const Sight& sight, const Gaze& gaze, std::vector<Constraint>& constraints) {
  if (sight.place.shape == Shape::sphere) {
    return integrate(sight, BallMap(sight.place, gaze.apex, gaze.weight), gaze, constraints);
  }
  if (sight.heights != nullptr) {
    return integrate(sight, ReliefMap(sight.place, *sight.heights, gaze.apex, gaze.weight), gaze, constraints);
  }
  return integrate(sight, PlaneMap(sight.place, gaze.apex, gaze.weight), gaze, constraints);
}

double in_own_frame(const Sight& sight, const Gaze& gaze, const ConeOfLight& cone) {
  const PlaneMap map(sight.place, gaze.apex, gaze.weight);
  if (!map.seen()) return 0.0;
  const hal::Vec3 from = gaze.apex - sight.place.centre;
  const hal::Vec3 apex{dot(from, sight.place.right), dot(from, sight.place.up), dot(from, sight.place.away)};
  const hal::Vec3 axis{dot(cone.axis, sight.place.right), dot(cone.axis, sight.place.up),
                       dot(cone.axis, sight.place.away)};
  const double weight = map.weight(0.0, 0.0, map.at(0.0, 0.0));
  return weight * light_in_section(sight.picture, apex, axis, cone.half_angle_rad, 1e-2 * gaze.tolerance / weight);
}

}  // namespace

double light_seen(const Sight& sight, const Gaze& gaze, const ConeOfLight& cone, std::vector<Constraint>& constraints) {
  const WithinCone inside = within(cone);
  if (!may_see(inside, sight.place.centre - gaze.apex, reach_of(sight))) return 0.0;
  if (sight.place.shape == Shape::plane && PlaneMap(sight.place, gaze.apex, gaze.weight).even()) {
    return in_own_frame(sight, gaze, cone);
  }
  constraints.clear();
  constraints.emplace_back(inside);
  append_front(sight, gaze.apex, constraints);
  return constrained(sight, gaze, constraints);
}

double light_hidden(const Sight& sight, const Gaze& gaze, const ConeOfLight& cone, std::span<const Shadow> shadows,
                    std::size_t k, std::vector<Constraint>& constraints) {
  const WithinCone inside = within(cone);
  if (!may_see(inside, sight.place.centre - gaze.apex, reach_of(sight))) return 0.0;
  constraints.clear();
  constraints.emplace_back(inside);
  append_front(sight, gaze.apex, constraints);
  shadows[k].append_inside(constraints);
  for (std::size_t j = 0; j < k; ++j) shadows[j].append_outside(constraints);
  return constrained(sight, gaze, constraints);
}

}  // namespace compueye::sim
