#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/sim/effect_rig.hpp"

namespace compueye::test {

/// Brightness of the object plane at (right, up) of its middle, mm.
using Brightness = std::function<double(double, double)>;

/// The picture stretched over the object plane, black beside it.
[[nodiscard]] inline Brightness brightness_of(const hal::Image& picture, const hal::ObjectPlane& object) {
  return [picture, object](double x, double y) {
    const double col = (x / object.width_mm + 0.5) * picture.cols, row = (0.5 - y / object.height_mm) * picture.rows;
    if (!(col >= 0.0 && col < picture.cols && row >= 0.0 && row < picture.rows)) return 0.0;
    return static_cast<double>(picture.at(static_cast<int>(row), static_cast<int>(col)));
  };
}

/// What the ray from an apex through the object plane at (right, up) meets.
using Seen = std::function<double(const hal::Vec3& apex, double x, double y)>;

/// What the optics deliver of it, LSB: cells of an 80th of the plane counted by whether the ray from the apex lies
/// within each cone. Shares nothing with the renderer.
[[nodiscard]] inline std::vector<double> ray_levels(const sim::OpticsAsBuilt& optics, const EffectRig& rig,
                                                    const Seen& seen) {
  const hal::ObjectPlane& object = rig.board.object;
  const double cell = object.width_mm / 80.0, beside = 6.0 * cell;  // mm
  const double z = object.z_mm(rig.board.eye);
  const double unit = object.pixel_width_mm() * object.pixel_height_mm() * rig.board.sensor.lsb();
  std::vector<double> levels;
  for (const sim::OmmatidiumOptics& ommatidium : optics.ommatidia) {
    std::vector<double> cosines;
    for (const sim::ConeOfLight& cone : ommatidium.cones) cosines.push_back(std::cos(cone.half_angle_rad));
    double sum = 0.0;
    for (double y = cell / 2.0 - object.height_mm / 2.0 - beside; y < object.height_mm / 2.0 + beside; y += cell) {
      for (double x = cell / 2.0 - object.width_mm / 2.0 - beside; x < object.width_mm / 2.0 + beside; x += cell) {
        const hal::Vec3 ray{x - ommatidium.apex_mm.x, y - ommatidium.apex_mm.y, z - ommatidium.apex_mm.z};
        const double length = std::sqrt(ray.x * ray.x + ray.y * ray.y + ray.z * ray.z);
        double weight = 0.0;
        for (std::size_t k = 0; k < cosines.size(); ++k) {
          const hal::Vec3& axis = ommatidium.cones[k].axis;
          if (ray.x * axis.x + ray.y * axis.y + ray.z * axis.z < cosines[k] * length) continue;
          weight += ommatidium.cones[k].weight;
        }
        if (weight == 0.0) continue;
        if (optics.obliquity != 0.0) weight *= std::pow(ray.z / length, optics.obliquity);
        sum += weight * seen(ommatidium.apex_mm, x, y);
      }
    }
    levels.push_back(sum * cell * cell / unit);
  }
  return levels;
}

[[nodiscard]] inline std::vector<double> plane_levels(const sim::OpticsAsBuilt& optics, const EffectRig& rig,
                                                      const Brightness& bright) {
  return ray_levels(optics, rig, [&](const hal::Vec3&, double x, double y) { return bright(x, y); });
}

[[nodiscard]] inline double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0.0;
  for (std::size_t m = 0; m < a.size(); ++m) squares += (a[m] - b[m]) * (a[m] - b[m]);
  return std::sqrt(squares / static_cast<double>(a.size()));
}

/// The rig's preview of it, with the figures that a preview has by moving the scene.
inline void look_at(EffectRig& rig, const Brightness& bright) {
  const auto moved = [&](double right, double up) {
    return plane_levels(sim::OpticsAsBuilt::drawn(rig.board.eye), rig,
                        [&](double x, double y) { return bright(x - right, y - up); });
  };
  const std::vector<double> still = moved(0.0, 0.0);
  rig.look_at(still);
  const auto columns = static_cast<std::size_t>(rig.board.eye.columns);
  const std::size_t rows = still.size() / columns;
  double squares = 0.0;
  for (std::size_t m = 0; m < still.size(); ++m) {
    double sum = 0.0;
    int count = 0;
    const auto add = [&](bool there, std::size_t other) {
      sum += there ? still[other] : 0.0;
      count += there ? 1 : 0;
    };
    add(m % columns > 0, m - 1);
    add(m % columns + 1 < columns, m + 1);
    add(m / columns > 0, m - columns);
    add(m / columns + 1 < rows, m + columns);
    squares += std::pow(still[m] - sum / count, 2);
  }
  rig.preview.neighbour_rms = std::sqrt(squares / static_cast<double>(still.size()));
  const double step = rig.board.object.width_mm / 16.0;
  for (const bool up : {false, true}) {
    const std::vector<double> after = moved(up ? 0.0 : step, up ? step : 0.0);
    const std::vector<double> before = moved(up ? 0.0 : -step, up ? -step : 0.0);
    double slopes = 0.0, bends = 0.0;
    for (std::size_t m = 0; m < still.size(); ++m) {
      slopes += std::pow((after[m] - before[m]) / (2.0 * step), 2);
      bends += std::pow((after[m] + before[m] - 2.0 * still[m]) / (step * step), 2);
    }
    const auto n = static_cast<double>(still.size());
    rig.preview.gradient_rms = std::max(rig.preview.gradient_rms, std::sqrt(slopes / n));
    rig.preview.laplacian_rms = std::max(rig.preview.laplacian_rms, std::sqrt(bends / n));
  }
}

/// 16x16 pixels of 0 to 1 that have nothing to do with each other.
[[nodiscard]] inline hal::Image pixel_noise(std::size_t which = 0) {
  hal::Image noise(16, 16);
  for (std::size_t n = 0; n < noise.pixels.size(); ++n) {
    noise.pixels[n] =
        static_cast<float>(static_cast<double>(((n + 1000 * which) * 2654435761U >> 7U) % 1000U) / 1000.0);
  }
  return noise;
}

/// Pictures on which bounds are tried: noise of pixels, an edge, broad waves, a bright spot on grey.
[[nodiscard]] inline std::vector<Brightness> tried_pictures(const hal::ObjectPlane& object) {
  const auto inside = [object](double x, double y) {
    return std::fabs(x) < object.width_mm / 2.0 && std::fabs(y) < object.height_mm / 2.0;
  };
  return {brightness_of(pixel_noise(), object),
          [inside](double x, double y) { return inside(x, y) && x + 0.3 * y > 0.7 ? 1.0 : 0.0; },
          [inside](double x, double y) { return inside(x, y) ? 0.5 + 0.4 * std::sin(1.5 * x + y) : 0.0; },
          [inside](double x, double y) {
            return !inside(x, y) ? 0.0 : std::hypot(x - 1.0, y + 1.0) < 0.8 ? 1.0 : 0.3;
          }};
}

}  // namespace compueye::test
