#pragma once

#include <functional>
#include <memory>
#include <span>

#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "sim/render/optics_as_built.hpp"
#include "sim/render/render_settings.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// Integrates the light of a scene over the cones of every ommatidium, below any pixel size and to a stated error; it
/// knows nothing of the pixels that a reconstruction will use.
///
/// Signal of an ommatidium: sum over its cones of weight times the integral of the radiance that arrives along the rays
/// within the cone, each ray weighing as the piece of the object plane that it meets (Lee et al., "COMPU-EYE", Optics
/// Express 24 (2016)), times cos^obliquity of its angle from z; unit: one pixel of the object plane at white. Radiance
/// does not change along a ray: what is white and fills the cone gives the same signal at any distance and tilt.
///
/// The back of a surface is dark, and hides as the front does; so is the hidden half of a ball. Planes and balls may
/// cut through one another. A relief hides parts of itself (its walls do not shine, and its heights are taken at the
/// corners of its picture's pixels), and casts on others the shadow of its rectangle. Surfaces that shine have blurred
/// pixel edges (edge_blur.hpp says how well). The tolerance is shared out over single cells by estimates that are
/// tested, not by a proof: see cell_integral.hpp.
class Renderer {
 public:
  /// `scene` must outlive it. Errors: those of validate(scene), and out_of_range or unsupported with the surface's
  /// name: a surface that reaches into the eye (behind the plane of the lens tip) at t = 0, a tolerance out of reach.
  [[nodiscard]] static hal::Result<Renderer> create(const hal::EyeGeometry& eye, const hal::ObjectPlane& object,
                                                    OpticsAsBuilt optics, const RenderSettings& settings,
                                                    const Scene& scene);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// Told the share of a rendering that is done, 0 .. 1, before every ommatidium of every surface; false: give up.
  using Watch = std::function<bool(double share)>;

  /// The M noise-free signals at `t_s`. What did not move since the last call costs nothing; does not allocate after
  /// the first call. A surface that has come into the eye is left out of the picture. False: the watch gave up, the
  /// signals are nobody's, and the next call renders everything.
  bool render(double t_s, std::span<double> signals, const Watch& watch = {});

  /// Surfaces integrated by the last render() (0: everything was as before).
  [[nodiscard]] int surfaces_rendered() const noexcept;

 private:
  struct Parts;
  explicit Renderer(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace compueye::sim
