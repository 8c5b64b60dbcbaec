#pragma once

#include <span>
#include <vector>

#include "sim/render/constraint.hpp"
#include "sim/render/light_map.hpp"
#include "sim/render/optics_as_built.hpp"
#include "sim/render/picture_sums.hpp"
#include "sim/render/shadow.hpp"

namespace compueye::sim {

/// What stays the same for every surface that an ommatidium sees.
struct Gaze {
  hal::Vec3 apex;
  RayWeight weight;
  double object_pixel_mm2 = 1.0;
  double tolerance = 1e-3;  ///< of each result
};

/// What is looked at: a surface's picture, for a relief its heights, and where it stands.
struct Sight {
  const PictureSums& picture;
  const ReliefHeights* heights = nullptr;
  const PlacedSurface& place;
  bool hides_itself = false;  ///< a relief, where occlusion counts
};

/// Light of a surface within one cone, nothing being in front of it, in pixels of the object plane. `constraints` is
/// room to work in.
[[nodiscard]] double light_seen(const Sight& sight, const Gaze& gaze, const ConeOfLight& cone,
                                std::vector<Constraint>& constraints);

/// That part of it which `shadows[k]` hides and none before it.
[[nodiscard]] double light_hidden(const Sight& sight, const Gaze& gaze, const ConeOfLight& cone,
                                  std::span<const Shadow> shadows, std::size_t k, std::vector<Constraint>& constraints);

}  // namespace compueye::sim
