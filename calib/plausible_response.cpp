#include "calib/plausible_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/pixel_grid.hpp"
#include "calib/row_draws.hpp"
#include "calib/smooth_field.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Vec3;

hal::Result<void> check(const BuildErrors& errors) {
  struct Range {
    std::string_view name;
    double value, lo, hi;
  };
  for (const Range& r :
       {Range{"pose_rad", errors.pose_rad, 0.0, 0.1}, Range{"gain", errors.gain, 0.0, 0.3},
        Range{"residual", errors.residual, 0.0, 0.3}, Range{"residual_pitch_px", errors.residual_pitch_px, 1.0, 1e6},
        Range{"soft_edge", errors.soft_edge, 0.0, 1.0}}) {
    if (r.value >= r.lo && r.value <= r.hi) continue;
    return fail(ErrorCode::out_of_range, "build errors: " + std::string(r.name),
                "is " + std::to_string(r.value) + ", expected " + std::to_string(r.lo) + " to " + std::to_string(r.hi));
  }
  return {};
}

/// One of the nested cones whose weights add up to an angular profile.
struct Cone {
  double half_angle_rad, weight;
};

/// Widest first. A smooth step t^2 (3 - 2t) down over `soft_edge` half angles about the nominal one; all half angles
/// are then shrunk together until their squares have the flat top's mean, which keeps the light that comes in.
std::vector<Cone> cones_of(double acceptance_rad, double soft_edge) {
  const double half = acceptance_rad / 2.0;
  if (soft_edge <= 0.0) return {{half, 1.0}};
  constexpr int count = 12;
  const auto fallen = [](double t) { return t * t * (3.0 - 2.0 * t); };
  std::vector<Cone> cones;
  double squares = 0.0;
  for (int k = count - 1; k >= 0; --k) {
    const double inner = static_cast<double>(k) / count, outer = (k + 1.0) / count;
    const Cone cone{1.0 + soft_edge * ((inner + outer) / 2.0 - 0.5), fallen(outer) - fallen(inner)};
    squares += cone.weight * cone.half_angle_rad * cone.half_angle_rad;
    cones.push_back(cone);
  }
  for (Cone& cone : cones) cone.half_angle_rad *= half / std::sqrt(squares);
  return cones;
}

/// The unit vector `axis` tilted by small angles about two directions across it.
Vec3 tilted(const Vec3& axis, double about_one_rad, double about_other_rad) {
  const Vec3 up = std::abs(axis.y) < 0.7 ? Vec3{0.0, 1.0, 0.0} : Vec3{1.0, 0.0, 0.0};
  const Vec3 one = unit(cross(up, axis)), other = cross(axis, one);
  return hal::unit({axis.x + about_one_rad * one.x + about_other_rad * other.x,
                    axis.y + about_one_rad * one.y + about_other_rad * other.y,
                    axis.z + about_one_rad * one.z + about_other_rad * other.z});
}

class Builder {
 public:
  Builder(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane, const BuildErrors& errors, std::uint64_t seed)
      : eye_(eye),
        plane_(plane),
        errors_(errors),
        seed_(seed),
        cones_(cones_of(eye.acceptance_rad, errors.soft_edge)),
        grid_(plane),
        sensitivity_(static_cast<std::size_t>(plane.pixels()), 0.0) {
    start_.push_back(0);
  }

  void add_row(int i, int k, bool blind) {
    if (!blind) expose(i, k);
    if (!touched_.empty()) build(RowDraws(seed_, static_cast<std::uint32_t>(2 * (i * eye_.columns + k) + 1)));
    start_.push_back(static_cast<std::int64_t>(values_.size()));
  }

  [[nodiscard]] hal::Result<recon::Response> response() && {
    auto response = TRY(recon::Response::from_csr(eye_.ommatidia(), plane_.pixels(), std::move(start_),
                                                  std::move(columns_), std::move(values_)));
    return std::move(response).with_image(plane_.rows, plane_.cols);
  }

 private:
  /// The mean sensitivity of every pixel in view, into touched_ and sensitivity_. The cones are nested.
  void expose(int i, int k) {
    RowDraws draws(seed_, static_cast<std::uint32_t>(2 * (i * eye_.columns + k)));
    gain_ = std::max(0.0, 1.0 + errors_.gain * draws.normal());
    const double one = errors_.pose_rad * draws.normal(), other = errors_.pose_rad * draws.normal();
    const Vec3 axis = tilted(eye_.axis(i, k), one, other);
    for (std::size_t c = 0; c < cones_.size(); ++c) {
      const ConeSection section(eye_.apex(i, k), axis, cones_[c].half_angle_rad, plane_.z_mm(eye_));
      grid_.for_each_covered(section, [&](std::int32_t pixel, double covered) {
        if (c == 0) touched_.push_back(pixel);
        sensitivity_[static_cast<std::size_t>(pixel)] += cones_[c].weight * covered;
      });
    }
  }

  void build(RowDraws draws) {
    const SmoothField residual(box(), errors_.residual_pitch_px, draws);
    for (const std::int32_t pixel : touched_) {
      const double uneven = 1.0 + errors_.residual * residual.at(pixel / plane_.cols, pixel % plane_.cols);
      double& sensitivity = sensitivity_[static_cast<std::size_t>(pixel)];
      const double value = gain_ * std::max(0.0, uneven) * std::exchange(sensitivity, 0.0);
      if (value < least_plausible_entry) continue;
      columns_.push_back(pixel);
      values_.push_back(value);
    }
    touched_.clear();
  }

  [[nodiscard]] PixelBox box() const {
    PixelBox box{touched_.front() / plane_.cols, touched_.back() / plane_.cols, plane_.cols, 0};
    for (const std::int32_t pixel : touched_) {
      box.first_col = std::min(box.first_col, pixel % plane_.cols);
      box.last_col = std::max(box.last_col, pixel % plane_.cols);
    }
    return box;
  }

  const hal::EyeGeometry& eye_;
  const hal::ObjectPlane& plane_;
  const BuildErrors& errors_;
  std::uint64_t seed_;
  std::vector<Cone> cones_;
  PixelGrid grid_;
  std::vector<double> sensitivity_;  // all zero between rows
  std::vector<std::int32_t> touched_;
  double gain_ = 1.0;
  std::vector<std::int64_t> start_;
  std::vector<std::int32_t> columns_;
  std::vector<double> values_;
};

}  // namespace

hal::Result<recon::Response> plausible_response(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane,
                                                const BuildErrors& errors, std::uint64_t seed,
                                                const Progress& progress) {
  TRY(check(errors));
  auto nominal = TRY(nominal_response(eye, plane, progress));
  const auto row_start = nominal.row_start();
  try {
    Builder builder(eye, plane, errors, seed);
    for (int i = 0; i < eye.rows; ++i) {
      for (int k = 0; k < eye.columns; ++k) {
        const auto m =
            static_cast<std::size_t>(i) * static_cast<std::size_t>(eye.columns) + static_cast<std::size_t>(k);
        builder.add_row(i, k, row_start[m] == row_start[m + 1]);
      }
      if (progress && !progress("build errors", i + 1.0, eye.rows)) {
        return fail(ErrorCode::interrupted, "response", "was given up before it was complete");
      }
    }
    return std::move(builder).response();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::no_space, "response",
                "does not fit into the memory of this machine: take fewer ommatidia or pixels, or a smaller acceptance "
                "angle");
  }
}

}  // namespace compueye::calib
