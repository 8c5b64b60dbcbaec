#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "sim/render/renderer.hpp"

namespace compueye::test {

/// Signals by brute force: rays evenly spread over each cone, each followed into the scene. Shares no code with the
/// renderer but the pose's unit vectors: no conic, no chord, no tile, no shadow.
class TracedRays {
 public:
  TracedRays(const hal::EyeGeometry& eye, const hal::ObjectPlane& object, const sim::Scene& scene, bool occlusion,
             int rays_across = 700)
      : eye_(eye), object_(object), scene_(scene), occlusion_(occlusion), n_(rays_across) {}

  [[nodiscard]] double signal(const sim::OmmatidiumOptics& one, double obliquity = 0.0) const {
    double sum = 0.0;
    for (const sim::ConeOfLight& cone : one.cones) sum += cone.weight * cone_signal(one.apex_mm, cone, obliquity);
    return sum;
  }

 private:
  struct Hit {
    double t = 0.0, light = 0.0;
    bool any = false;
  };

  static double dot(const hal::Vec3& a, const hal::Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static hal::Vec3 cross(const hal::Vec3& a, const hal::Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }

  // Rings of equal solid angle, turned by the golden angle from one to the next.
  [[nodiscard]] double cone_signal(const hal::Vec3& apex, const sim::ConeOfLight& cone, double obliquity) const {
    const hal::Vec3 z = cone.axis;
    hal::Vec3 x = std::fabs(z.x) < 0.9 ? cross({1, 0, 0}, z) : cross({0, 1, 0}, z);
    const double nx = std::sqrt(dot(x, x));
    x = {x.x / nx, x.y / nx, x.z / nx};
    const hal::Vec3 y = cross(z, x);
    const double cap = 1.0 - std::cos(cone.half_angle_rad), pi = std::numbers::pi;
    const long count = static_cast<long>(n_) * n_;
    double sum = 0.0;
    for (long k = 0; k < count; ++k) {
      const double c = 1.0 - cap * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
      const double s = std::sqrt(1.0 - c * c);
      const double phi = 2.0 * pi * std::fmod(static_cast<double>(k) * 0.6180339887498949, 1.0);
      const double a = s * std::cos(phi), b = s * std::sin(phi);
      const hal::Vec3 d{a * x.x + b * y.x + c * z.x, a * x.y + b * y.y + c * z.y, a * x.z + b * y.z + c * z.z};
      if (d.z > 1e-9) sum += light(apex, d) * std::pow(d.z, obliquity - 3.0);
    }
    const double depth = object_.z_mm(eye_) - apex.z;
    const double pixel = object_.pixel_width_mm() * object_.pixel_height_mm();
    return sum * 2.0 * pi * cap / static_cast<double>(count) * depth * depth / pixel;
  }

  [[nodiscard]] double light(const hal::Vec3& apex, const hal::Vec3& d) const {
    Hit nearest;
    double sum = 0.0;
    for (const sim::Surface& surface : scene_.surfaces) {
      const Hit hit = surface.shape == sim::Shape::sphere   ? ball(surface, apex, d)
                      : surface.shape == sim::Shape::relief ? relief(surface, apex, d)
                                                            : plane(surface, apex, d);
      if (!hit.any) continue;
      sum += hit.light;
      if (!nearest.any || hit.t <= nearest.t) nearest = hit;
    }
    return occlusion_ ? nearest.light : sum;
  }

  [[nodiscard]] hal::Vec3 from_centre(const sim::Surface& surface, const hal::Vec3& apex) const {
    const double z = eye_.radius_mm + eye_.lens_height_mm + surface.distance_mm.value_or(object_.distance_mm);
    return {apex.x - surface.pose.centre_mm.x, apex.y - surface.pose.centre_mm.y, apex.z - z};
  }

  [[nodiscard]] static double picture(const sim::Surface& surface, double x, double y) {
    const hal::Image& image = surface.picture();
    const double height = surface.shape == sim::Shape::sphere ? surface.width_mm : surface.height_mm;
    const int col = static_cast<int>(std::floor((x / surface.width_mm + 0.5) * image.cols));
    const int row = static_cast<int>(std::floor((0.5 - y / height) * image.rows));
    if (row < 0 || col < 0 || row >= image.rows || col >= image.cols) return -1.0;
    return static_cast<double>(image.at(row, col));
  }

  [[nodiscard]] Hit plane(const sim::Surface& surface, const hal::Vec3& apex, const hal::Vec3& d) const {
    const hal::Vec3 r = surface.pose.right(), u = surface.pose.up(), n = cross(r, u);
    const hal::Vec3 a = from_centre(surface, apex);
    const double t = -dot(a, n) / dot(d, n);
    if (!(t > 0.0)) return {};
    const hal::Vec3 p{a.x + t * d.x, a.y + t * d.y, a.z + t * d.z};
    const double value = picture(surface, dot(p, r), dot(p, u));
    if (value < 0.0) return {};
    return {t, dot(d, n) > 0.0 ? value : 0.0, true};
  }

  [[nodiscard]] Hit ball(const sim::Surface& surface, const hal::Vec3& apex, const hal::Vec3& d) const {
    const hal::Vec3 a = from_centre(surface, apex);
    const double b = dot(a, d), radius = surface.width_mm / 2.0;
    const double root = b * b - dot(a, a) + radius * radius;
    if (root < 0.0) return {};
    const double t = -b - std::sqrt(root);
    if (!(t > 0.0)) return {};
    const hal::Vec3 p{a.x + t * d.x, a.y + t * d.y, a.z + t * d.z};
    const hal::Vec3 r = surface.pose.right(), u = surface.pose.up();
    const bool front = dot(p, cross(r, u)) < 0.0;
    const double value = picture(surface, dot(p, r), dot(p, u));
    return {t, front && value > 0.0 ? value : 0.0, true};
  }

  /// Bilinear between the middles of the height map's pixels, level beyond the outermost.
  [[nodiscard]] static double height(const hal::Image& map, double x, double y) {
    const auto place = [](double pixels, int count) {
      return std::fmin(std::fmax(pixels - 0.5, 0.0), static_cast<double>(count - 1));
    };
    const double c = place(x * map.cols, map.cols), r = place(y * map.rows, map.rows);
    const int c0 = static_cast<int>(c), r0 = static_cast<int>(r);
    const int c1 = c0 + 1 < map.cols ? c0 + 1 : c0, r1 = r0 + 1 < map.rows ? r0 + 1 : r0;
    const double fc = c - c0, fr = r - r0;
    const auto at = [&](int row, int col) { return static_cast<double>(map.at(row, col)); };
    return (1 - fr) * ((1 - fc) * at(r0, c0) + fc * at(r0, c1)) + fr * ((1 - fc) * at(r1, c0) + fc * at(r1, c1));
  }

  // In steps along the ray through the slab of its heights, then by halving.
  [[nodiscard]] Hit relief(const sim::Surface& surface, const hal::Vec3& apex, const hal::Vec3& d) const {
    const hal::Vec3 r = surface.pose.right(), u = surface.pose.up(), n = cross(r, u);
    const hal::Vec3 a = from_centre(surface, apex);
    double lo = 0.0, hi = 0.0;
    for (const float h : surface.heights.pixels) {
      lo = std::fmin(lo, static_cast<double>(h));
      hi = std::fmax(hi, static_cast<double>(h));
    }
    const double slope = dot(d, n);
    if (!(slope > 1e-6)) return {};
    const double t0 = (-hi - 1e-9 - dot(a, n)) / slope, t1 = (-lo + 1e-9 - dot(a, n)) / slope;
    const auto above = [&](double t) {
      const hal::Vec3 p{a.x + t * d.x, a.y + t * d.y, a.z + t * d.z};
      const double x = dot(p, r) / surface.width_mm + 0.5, y = 0.5 - dot(p, u) / surface.height_mm;
      if (x < 0.0 || x > 1.0 || y < 0.0 || y > 1.0) return 1.0;
      return -dot(p, n) - height(surface.heights, x, y);
    };
    constexpr int steps = 600;
    for (int k = 0; k < steps; ++k) {
      double from = t0 + (t1 - t0) * k / steps, to = t0 + (t1 - t0) * (k + 1) / steps;
      if (above(to) > 0.0 || !(above(from) > 0.0)) continue;
      for (int halving = 0; halving < 30; ++halving) {
        const double middle = 0.5 * (from + to);
        (above(middle) > 0.0 ? from : to) = middle;
      }
      const hal::Vec3 p{a.x + to * d.x, a.y + to * d.y, a.z + to * d.z};
      const double value = picture(surface, dot(p, r), dot(p, u));
      // A ray that comes in under the relief's edge meets nothing there.
      const double x = std::fabs(dot(p, r)) / surface.width_mm, y = std::fabs(dot(p, u)) / surface.height_mm;
      if (std::fmax(x, y) > 0.5 - 1e-6) continue;
      return {to, value > 0.0 ? value : 0.0, value >= 0.0};
    }
    return {};
  }

  hal::EyeGeometry eye_;
  hal::ObjectPlane object_;
  const sim::Scene& scene_;
  bool occlusion_;
  int n_;
};

}  // namespace compueye::test
