#include "sim/render/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hal/try.hpp"
#include "sim/render/edge_blur.hpp"
#include "sim/render/surface_light.hpp"

namespace compueye::sim {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

/// Of a rendering, told to whoever watches it.
class Steps {
 public:
  Steps(const Renderer::Watch& watch, std::size_t all) : watch_(watch), all_(static_cast<double>(all)) {}
  [[nodiscard]] bool next() { return !watch_ || watch_(done_++ / all_); }

 private:
  const Renderer::Watch& watch_;
  double done_ = 0.0, all_;
};

/// One surface and what every ommatidium has of it.
struct Rendered {
  const Surface* surface = nullptr;
  PictureSums sums;
  std::optional<ReliefHeights> heights;
  PlacedSurface place, before;  ///< now, and at the last call
  bool moved = true;
  std::vector<double> seen, hidden;  ///< M
};

Result<void> check(const OpticsAsBuilt& optics, const hal::EyeGeometry& eye) {
  constexpr double widest = std::numbers::pi / 3.0 * (1.0 + 1e-12);
  if (optics.ommatidia.size() != static_cast<std::size_t>(eye.ommatidia())) {
    return fail(ErrorCode::mismatch, "optics",
                "has " + std::to_string(optics.ommatidia.size()) + " ommatidia, expected the eye's " +
                    std::to_string(eye.ommatidia()));
  }
  if (!std::isfinite(optics.obliquity)) return fail(ErrorCode::out_of_range, "optics.obliquity", "is not a number");
  for (std::size_t m = 0; m < optics.ommatidia.size(); ++m) {
    const std::string place = "optics of ommatidium " + std::to_string(m);
    const OmmatidiumOptics& one = optics.ommatidia[m];
    if (!std::isfinite(length(one.apex_mm))) return fail(ErrorCode::out_of_range, place, "the apex is not finite");
    for (const ConeOfLight& cone : one.cones) {
      if (!(cone.half_angle_rad > 0.0 && cone.half_angle_rad <= widest)) {
        return fail(ErrorCode::out_of_range, place,
                    "half angle is " + std::to_string(cone.half_angle_rad * 180.0 / std::numbers::pi) +
                        " deg, expected more than 0 and at most 60");
      }
      if (!std::isfinite(cone.weight)) return fail(ErrorCode::out_of_range, place, "a weight is not finite");
      if (!(std::fabs(length(cone.axis) - 1.0) < 1e-6)) {
        return fail(ErrorCode::out_of_range, place, "an axis is not a unit vector");
      }
    }
  }
  return {};
}

Result<void> check(const RenderSettings& settings) {
  if (!(settings.tolerance >= 1e-9 && std::isfinite(settings.tolerance))) {
    return fail(ErrorCode::out_of_range, "render.tolerance",
                "is " + std::to_string(settings.tolerance) + ", expected 1e-9 or more");
  }
  if (!(settings.pixel_edge_blur >= 0.0 && settings.pixel_edge_blur <= 1.0)) {
    return fail(ErrorCode::out_of_range, "render.pixel_edge_blur",
                "is " + std::to_string(settings.pixel_edge_blur) + ", expected 0 to 1");
  }
  return {};
}

/// Each pixel `down` x `across` times.
hal::Image repeated(const hal::Image& picture, int down, int across) {
  hal::Image finer(picture.rows * down, picture.cols * across);
  for (int row = 0; row < finer.rows; ++row) {
    for (int col = 0; col < finer.cols; ++col) finer.at(row, col) = picture.at(row / down, col / across);
  }
  return finer;
}

/// A relief's heights change from pixel to pixel, so its picture is at least as fine as they are. Its edges stay sharp.
PictureSums sums_of(const Surface& surface, const PlacedSurface& place, const RenderSettings& settings, bool tiles) {
  hal::Image made;
  if (surface.bands.size() != 1) made = surface.grey();
  const hal::Image& picture = surface.bands.size() != 1 ? made : surface.picture();
  double width = 2.0 * place.half_width, height = 2.0 * place.half_height;
  if (place.shape == Shape::relief) {
    const auto times = [](int wanted, int have) { return std::max(1, (wanted + have - 1) / have); };
    return {repeated(picture, times(surface.heights.rows, picture.rows), times(surface.heights.cols, picture.cols)),
            width, height, tiles};
  }
  if (surface.shines && settings.pixel_edge_blur > 0.0) {
    width *= (picture.cols + 2.0) / picture.cols;
    height *= (picture.rows + 2.0) / picture.rows;
    const int parts = parts_for_blur(picture, settings.pixel_edge_blur);
    return {with_blurred_edges(picture, settings.pixel_edge_blur, parts), width, height, tiles};
  }
  return {picture, width, height, tiles};
}

}  // namespace

struct Renderer::Parts {
  hal::EyeGeometry eye;
  hal::ObjectPlane object;
  OpticsAsBuilt optics;
  RenderSettings settings;
  const Scene* scene = nullptr;
  double object_z = 0.0, nearest_z = 0.0;
  std::vector<Rendered> surfaces;
  std::vector<double> tolerance;  ///< of an ommatidium, for each integral of it
  std::vector<Shadow> shadows;
  std::vector<std::size_t> casting;  ///< surfaces, as in shadows
  std::vector<Constraint> constraints;
  int rendered = 0;
  bool given_up = false;  ///< at the last call: nothing is as it was left

  [[nodiscard]] PlacedSurface placed(const Surface& surface, double t_s) const {
    Surface flat;
    Pose pose = surface.pose;
    pose.centre_mm.z = object_z;
    if (settings.true_depth && surface.distance_mm) {
      pose.centre_mm.z = eye.radius_mm + eye.lens_height_mm + *surface.distance_mm;
    }
    if (settings.motion) pose = surface.motion.moved(pose, t_s);
    PlacedSurface place(surface, pose);
    if (!settings.true_depth) {
      place = flattened(surface, pose);
    }
    place.present = place.nearest_z() > nearest_z && std::isfinite(place.centre.x + place.centre.y + place.centre.z);
    return place;
  }

  [[nodiscard]] PlacedSurface flattened(const Surface& surface, const Pose& pose) const {
    PlacedSurface place;
    place.centre = {pose.centre_mm.x, pose.centre_mm.y, object_z};
    const double c = std::cos(pose.roll_rad), s = std::sin(pose.roll_rad);
    place.right = {c, s, 0.0};
    place.up = {-s, c, 0.0};
    place.away = {0.0, 0.0, 1.0};
    place.half_width = surface.width_mm / 2.0;
    place.half_height = surface.shape == Shape::sphere ? place.half_width : surface.height_mm / 2.0;
    place.reach = std::hypot(place.half_width, place.half_height);
    return place;
  }

  [[nodiscard]] Gaze gaze(std::size_t m) const {
    const double pixel = object.pixel_width_mm() * object.pixel_height_mm();
    const hal::Vec3& apex = optics.ommatidia[m].apex_mm;
    const double depth = object_z - apex.z;
    return {apex, {depth * depth / pixel, optics.obliquity}, pixel, tolerance[m]};
  }

  void place(double t_s) {
    for (Rendered& one : surfaces) {
      one.before = one.place;
      one.place = placed(*one.surface, t_s);
    }
  }

  [[nodiscard]] Sight sight(const Rendered& one) const {
    return {one.sums, one.heights ? &*one.heights : nullptr, one.place, one.heights && settings.occlusion};
  }

  [[nodiscard]] bool see(Rendered& one, Steps& steps) {
    for (std::size_t m = 0; m < one.seen.size(); ++m) {
      if (!steps.next()) return false;
      one.seen[m] = 0.0;
      if (!one.place.present) continue;
      const Gaze here = gaze(m);
      for (const ConeOfLight& cone : optics.ommatidia[m].cones) {
        if (cone.weight != 0.0) one.seen[m] += cone.weight * light_seen(sight(one), here, cone, constraints);
      }
    }
    return true;
  }

  /// Whether `front` stands, or stood, where an ommatidium looks.
  [[nodiscard]] bool touched(const Rendered& front, const OmmatidiumOptics& one) const {
    for (const ConeOfLight& cone : one.cones) {
      const WithinCone inside{cone.axis, std::sin(cone.half_angle_rad), std::cos(cone.half_angle_rad)};
      for (const PlacedSurface* place : {&front.place, &front.before}) {
        if (place->reach > 0.0 && may_see(inside, place->centre - one.apex_mm, place->reach)) return true;
      }
    }
    return false;
  }

  [[nodiscard]] bool outdated(std::size_t behind, const OmmatidiumOptics& one) const {
    if (surfaces[behind].moved) return true;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      if (s != behind && surfaces[s].moved && touched(surfaces[s], one)) return true;
    }
    return false;
  }

  [[nodiscard]] double hidden(std::size_t behind, std::size_t m) {
    const OmmatidiumOptics& one = optics.ommatidia[m];
    shadows.clear();
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      if (s == behind || !surfaces[s].place.present) continue;
      Shadow shadow(surfaces[s].place, one.apex_mm, s > behind);
      if (shadow.falls_on(surfaces[behind].place, one.apex_mm)) shadows.push_back(shadow);
    }
    const Gaze here = gaze(m);
    double sum = 0.0;
    for (const ConeOfLight& cone : one.cones) {
      if (cone.weight == 0.0) continue;
      for (std::size_t k = 0; k < shadows.size(); ++k) {
        sum += cone.weight * light_hidden(sight(surfaces[behind]), here, cone, shadows, k, constraints);
      }
    }
    return sum;
  }

  /// `any` becomes true where something had to be integrated.
  [[nodiscard]] bool hide(std::size_t behind, Steps& steps, bool& any) {
    Rendered& one = surfaces[behind];
    for (std::size_t m = 0; m < one.hidden.size(); ++m) {
      if (!outdated(behind, optics.ommatidia[m])) continue;
      if (!steps.next()) return false;
      any = true;
      one.hidden[m] = one.place.present ? hidden(behind, m) : 0.0;
    }
    return true;
  }

  /// Integrals of an ommatidium that are to come, at most.
  [[nodiscard]] std::size_t steps_to_come() const {
    std::size_t all = 0;
    bool any = false;
    for (const Rendered& one : surfaces) {
      any = any || one.moved;
      if (one.moved) all += one.seen.size();
    }
    return all + (any && settings.occlusion ? surfaces.size() * optics.ommatidia.size() : 0);
  }

  [[nodiscard]] bool render(std::span<double> signals, Steps& steps) {
    rendered = 0;
    for (Rendered& one : surfaces) {
      if (one.moved && !see(one, steps)) return false;
    }
    std::fill(signals.begin(), signals.end(), 0.0);
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      const Rendered& one = surfaces[s];
      bool hiding = false;
      if (settings.occlusion && !hide(s, steps, hiding)) return false;
      if (one.moved || hiding) ++rendered;
      for (std::size_t m = 0; m < signals.size(); ++m) signals[m] += one.seen[m] - one.hidden[m];
    }
    return true;
  }
};

Renderer::Renderer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Result<Renderer> Renderer::create(const hal::EyeGeometry& eye, const hal::ObjectPlane& object, OpticsAsBuilt optics,
                                  const RenderSettings& settings, const Scene& scene) {
  TRY(eye.validate());
  TRY(object.validate());
  TRY(check(optics, eye));
  TRY(check(settings));
  TRY(validate(scene));
  auto parts = std::make_unique<Parts>();
  parts->eye = eye;
  parts->object = object;
  parts->settings = settings;
  parts->scene = &scene;
  parts->object_z = object.z_mm(eye);
  parts->nearest_z = eye.radius_mm + eye.lens_height_mm;
  for (const OmmatidiumOptics& one : optics.ommatidia) {
    parts->nearest_z = std::max(parts->nearest_z, one.apex_mm.z);
    double weights = 0.0;
    for (const ConeOfLight& cone : one.cones) weights += std::fabs(cone.weight);
    parts->tolerance.push_back(settings.tolerance / std::max(1.0, weights) /
                               static_cast<double>(scene.surfaces.size()));
  }
  parts->optics = std::move(optics);
  for (const Surface& surface : scene.surfaces) {
    const PlacedSurface place = parts->placed(surface, 0.0);
    if (!place.present) {
      return fail(ErrorCode::out_of_range, surface.name,
                  "reaches " + std::to_string(parts->nearest_z - place.nearest_z()) +
                      " mm into the eye, expected all of it before the lens tip");
    }
    const bool tiles = settings.occlusion || settings.true_depth || parts->optics.obliquity != 0.0;
    Rendered one{&surface, sums_of(surface, place, settings, tiles), {}, {}, {}, true, {}, {}};
    if (place.shape == Shape::relief) {
      one.heights.emplace(surface.heights, one.sums.rows(), one.sums.cols(), surface.width_mm, surface.height_mm);
    }
    one.seen.resize(parts->optics.ommatidia.size());
    one.hidden.resize(parts->optics.ommatidia.size());
    parts->surfaces.push_back(std::move(one));
  }
  parts->shadows.reserve(scene.surfaces.size());
  parts->constraints.reserve(scene.surfaces.size() + 8);
  for (Rendered& one : parts->surfaces) one.place.present = false;
  return Renderer(std::move(parts));
}

bool Renderer::render(double t_s, std::span<double> signals, const Watch& watch) {
  Parts& parts = *parts_;
  parts.place(t_s);
  for (Rendered& one : parts.surfaces) one.moved = parts.given_up || !one.place.stands_as(one.before);
  Steps steps(watch, parts.steps_to_come());
  parts.given_up = !parts.render(signals, steps);
  return !parts.given_up;
}

int Renderer::surfaces_rendered() const noexcept {
  return parts_->rendered;
}

}  // namespace compueye::sim
