#pragma once

#include <vector>

#include "hal/eye_geometry.hpp"
#include "hal/result.hpp"
#include "sim/angular_profile.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::sim {

/// How the light of a scene reaches the ommatidia: a forward model of its own that integrates the scene's picture
/// through each ommatidium's cone, knowing nothing of the pixels that a reconstruction will use.
///
/// Signal of an ommatidium = sum over shells of weight times the integral of the picture over the conic in which the
/// shell's cone meets the scene's plane, in units of one pixel of the object plane at white. A scene at another
/// distance than the object plane is projected on it along the rays through each apex, since radiance does not change
/// along a ray: a white scene that fills the cone gives the same signal at any distance. The geometry is
/// that of Lee et al., "COMPU-EYE", Optics Express 24 (2016); the integral is carried out below pixel size.
struct Optics {
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  AngularProfile profile;  ///< AngularProfile::flat_top(eye.acceptance_rad) for the eye as it stands

  /// Gauss cells (two scanlines each) along the cone's edge per pixel of the object plane, at least one a scene pixel:
  /// 1 .. 1024. Time grows in proportion, the error falls as the square or faster. Largest error of any signal over
  /// binary scenes on 80x80 ommatidia of 60 deg: .03 units at 8, .007 at 16, .0013 at 32.
  int cells_per_pixel = 32;

  [[nodiscard]] hal::Result<void> validate() const;

  /// Noise-free signals of all ommatidia, m = i * columns + k. Errors: those of validate() and of the scene.
  [[nodiscard]] hal::Result<std::vector<double>> expose(const Scene& scene) const;
};

}  // namespace compueye::sim
