#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "sim/pictures/built_in_scenes.hpp"
#include "sim/render/renderer.hpp"
#include "tests/hal/units.hpp"

namespace compueye::test {

/// An eye before its object plane, and how a scene is rendered for it.
struct RenderRig {
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  sim::RenderSettings settings;
};

/// 8x8 ommatidia before 16x16 pixels; surfaces are where they are.
[[nodiscard]] inline RenderRig small_eye(double acceptance_deg = 8.0) {
  RenderRig rig;
  rig.eye.interommatidial_rad = 1.5 * deg;
  rig.eye.acceptance_rad = acceptance_deg * deg;
  rig.settings.true_depth = true;
  return rig;
}

/// The field of 80x80 ommatidia 2.25 deg apart, with every fourth of them.
[[nodiscard]] inline RenderRig wide_eye() {
  RenderRig rig = small_eye(60.0);
  rig.eye.rows = rig.eye.columns = 20;
  rig.eye.interommatidial_rad = 9.0 * deg;
  rig.object = {160, 160, 60.0, 60.0, 10.0};
  return rig;
}

[[nodiscard]] inline std::vector<double> rendered(const RenderRig& rig, const sim::Scene& scene,
                                                  const sim::OpticsAsBuilt& optics, double t_s = 0.0) {
  auto renderer = sim::Renderer::create(rig.eye, rig.object, optics, rig.settings, scene);
  REQUIRE_MESSAGE(renderer.has_value(), (renderer ? "" : renderer.error().text()));
  std::vector<double> signals(optics.ommatidia.size());
  renderer->render(t_s, signals);
  return signals;
}

[[nodiscard]] inline std::vector<double> rendered(const RenderRig& rig, const sim::Scene& scene, double t_s = 0.0) {
  return rendered(rig, scene, sim::OpticsAsBuilt::drawn(rig.eye), t_s);
}

[[nodiscard]] inline hal::Image picture_of(const char* name, const hal::ObjectPlane& object, std::uint64_t seed = 0) {
  return sim::render_built_in(name, object.rows, object.cols, seed).value();
}

[[nodiscard]] inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t m = 0; m < a.size(); ++m) largest = std::max(largest, std::fabs(a[m] - b[m]));
  return largest;
}

/// The cone itself, point by point: `n` x `n` points in every pixel of a sheet that lies on the object plane, no conic
/// and no chord.
[[nodiscard]] inline double sampled_signal(const RenderRig& rig, const sim::Scene& scene, int i, int k, int n) {
  const sim::Surface& sheet = scene.surfaces[0];
  const hal::Vec3 apex = rig.eye.apex(i, k), axis = rig.eye.axis(i, k);
  const double z = rig.object.z_mm(rig.eye) - apex.z;
  const double pitch_x = sheet.width_mm / sheet.picture().cols, pitch_y = sheet.height_mm / sheet.picture().rows;
  double sum = 0.0;
  for (int row = 0; row < sheet.picture().rows * n; ++row) {
    const double y = sheet.height_mm / 2.0 - (row + 0.5) * pitch_y / n - apex.y;
    for (int col = 0; col < sheet.picture().cols * n; ++col) {
      const double x = (col + 0.5) * pitch_x / n - sheet.width_mm / 2.0 - apex.x;
      const double angle = std::acos((x * axis.x + y * axis.y + z * axis.z) / std::sqrt(x * x + y * y + z * z));
      if (angle <= rig.eye.acceptance_rad / 2.0) sum += static_cast<double>(sheet.picture().at(row / n, col / n));
    }
  }
  return sum * pitch_x * pitch_y / (n * n) / (rig.object.pixel_width_mm() * rig.object.pixel_height_mm());
}

}  // namespace compueye::test
