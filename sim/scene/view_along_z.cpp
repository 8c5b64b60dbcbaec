#include "sim/scene/view_along_z.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace compueye::sim {
namespace {

/// Where a ray along z meets a surface: how far away, and at which light.
struct Hit {
  double z_mm = 0.0;
  double light = 0.0;
};

/// A surface at its place at one time.
class Placed {
 public:
  Placed(const Surface& surface, const hal::ObjectPlane& object, double t_s) : surface_(surface) {
    Pose at_rest = surface.pose;
    at_rest.centre_mm.z = surface.distance_mm.value_or(object.distance_mm);
    const Pose pose = surface.motion.moved(at_rest, t_s);
    centre_ = pose.centre_mm;
    right_ = pose.right();
    up_ = pose.up();
    across_ = right_.x * up_.y - right_.y * up_.x;
  }

  [[nodiscard]] std::optional<Hit> at(double x, double y) const noexcept {
    return surface_.shape == Shape::sphere ? on_ball(x - centre_.x, y - centre_.y)
                                           : on_sheet(x - centre_.x, y - centre_.y);
  }

 private:
  [[nodiscard]] std::optional<Hit> on_sheet(double x, double y) const noexcept {
    constexpr double edge_on = 1e-9;
    if (std::fabs(across_) < edge_on) return std::nullopt;
    const double u = (x * up_.y - y * up_.x) / across_, v = (y * right_.x - x * right_.y) / across_;
    return lit_at(u, v, centre_.z + u * right_.z + v * up_.z);
  }
  /// The front half has the picture.
  [[nodiscard]] std::optional<Hit> on_ball(double x, double y) const noexcept {
    const double radius = surface_.width_mm / 2.0;
    const double depth2 = radius * radius - x * x - y * y;
    if (!(depth2 >= 0.0)) return std::nullopt;
    const double z = -std::sqrt(depth2);
    const double u = x * right_.x + y * right_.y + z * right_.z, v = x * up_.x + y * up_.y + z * up_.z;
    return lit_at(u, v, centre_.z + z);
  }
  [[nodiscard]] std::optional<Hit> lit_at(double u, double v, double z) const noexcept {
    const hal::Image& picture = surface_.picture();
    const double across = u / surface_.width_mm + 0.5, down = 0.5 - v / surface_.height_mm;
    if (!(across >= 0.0 && across <= 1.0 && down >= 0.0 && down <= 1.0)) return std::nullopt;
    const int row = std::min(static_cast<int>(down * picture.rows), picture.rows - 1);
    const int col = std::min(static_cast<int>(across * picture.cols), picture.cols - 1);
    double light = 0.0;
    for (const hal::Image& band : surface_.bands) light += static_cast<double>(band.at(row, col));
    return Hit{z, light / static_cast<double>(surface_.bands.size())};
  }

  const Surface& surface_;
  hal::Vec3 centre_, right_, up_;
  double across_ = 0.0;  ///< of the sheet's area, seen along z
};

double light_at(const std::vector<Placed>& surfaces, double x, double y) noexcept {
  Hit nearest{std::numeric_limits<double>::infinity(), 0.0};
  for (const Placed& surface : surfaces) {
    const std::optional<Hit> hit = surface.at(x, y);
    if (hit && hit->z_mm <= nearest.z_mm) nearest = *hit;
  }
  return nearest.light;
}

int samples_a_side(const Scene& scene, const hal::ObjectPlane& object) {
  constexpr int least = 4, most = 8;
  double finest = 1.0;
  for (const Surface& surface : scene.surfaces) {
    finest = std::max(finest, object.pixel_width_mm() * surface.picture().cols / surface.width_mm);
    finest = std::max(finest, object.pixel_height_mm() * surface.picture().rows / surface.height_mm);
  }
  return static_cast<int>(std::clamp(std::ceil(finest), static_cast<double>(least), static_cast<double>(most)));
}

}  // namespace

hal::Image view_along_z(const Scene& scene, const hal::ObjectPlane& object, double t_s) {
  std::vector<Placed> surfaces;
  for (const Surface& surface : scene.surfaces) surfaces.emplace_back(surface, object, t_s);
  const int side = samples_a_side(scene, object);
  hal::Image view(object.rows, object.cols);
  for (int row = 0; row < view.rows; ++row) {
    for (int col = 0; col < view.cols; ++col) {
      double sum = 0.0;
      for (int s = 0; s < side * side; ++s) {
        const double across = col + (s % side + 0.5) / side, down = row + (s / side + 0.5) / side;
        sum += light_at(surfaces, across * object.pixel_width_mm() - object.width_mm / 2.0,
                        object.height_mm / 2.0 - down * object.pixel_height_mm());
      }
      view.at(row, col) = static_cast<float>(sum / (side * side));
    }
  }
  return view;
}

}  // namespace compueye::sim
