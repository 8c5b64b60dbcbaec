#include "sim/optics.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "hal/try.hpp"
#include "sim/picture_integral.hpp"
#include "sim/render/cone_section.hpp"

namespace compueye::sim {
namespace {

struct CellDensity {
  double per_mm_across = 0.0, per_mm_down = 0.0;
};

/// Integrates a picture over one cone section, scanline by scanline. Rows of the picture are never mixed in a cell,
/// since brightness jumps between them.
class SectionIntegral {
 public:
  SectionIntegral(const PictureIntegral& picture, const ConeSection& section, const hal::Vec3& apex,
                  const CellDensity& density)
      : picture_(picture), section_(section), apex_(apex), density_(density) {}

  [[nodiscard]] double value() const {
    const Interval u = section_.u_range();
    if (u.empty() || u.hi + apex_.x <= picture_.left_mm() || u.lo + apex_.x >= picture_.right_mm()) return 0.0;
    const Interval v = section_.v_range();
    if (v.empty()) return 0.0;
    // A chord shrinks like a square root towards a finite end. Stepping evenly in the root of the distance from that
    // end makes the integrand smooth again.
    const bool from_below = std::isfinite(v.lo);
    const bool from_above = std::isfinite(v.hi);
    if (from_below && from_above) {
      const double middle = 0.5 * (v.lo + v.hi);
      return piece({v.lo, middle}, {v.lo, 1.0}) + piece({middle, v.hi}, {v.hi, -1.0});
    }
    if (from_below) return piece(v, {v.lo, 1.0});
    if (from_above) return piece(v, {v.hi, -1.0});
    return piece(v, {0.0, 0.0});
  }

 private:
  /// v = end + sign t^2, or v = t without a finite end (sign 0).
  struct Stepping {
    double end, sign;
    [[nodiscard]] double t(double v) const { return sign == 0.0 ? v : std::sqrt(std::max(0.0, (v - end) * sign)); }
    [[nodiscard]] double v(double t) const { return sign == 0.0 ? t : end + sign * t * t; }
    [[nodiscard]] double slope(double t) const { return sign == 0.0 ? 1.0 : 2.0 * t; }
  };

  [[nodiscard]] Interval clipped_chord(double v) const {
    const Interval chord = section_.chord(v);
    if (chord.empty()) return {};
    return {std::max(chord.lo + apex_.x, picture_.left_mm()), std::min(chord.hi + apex_.x, picture_.right_mm())};
  }

  [[nodiscard]] double piece(const Interval& v, const Stepping& stepping) const {
    const double top = picture_.top_of_mm(0);
    const double height = picture_.pixel_height_mm();
    const int rows = picture_.rows();
    const auto row_at = [&](double y) {
      return static_cast<int>(std::clamp((top - y) / height, 0.0, static_cast<double>(rows - 1)));
    };
    double sum = 0.0;
    for (int row = row_at(v.hi + apex_.y), last = row_at(v.lo + apex_.y); row <= last; ++row) {
      if (picture_.black(row)) continue;
      const Interval inside{std::max(v.lo, picture_.top_of_mm(row + 1) - apex_.y),
                            std::min(v.hi, picture_.top_of_mm(row) - apex_.y)};
      if (inside.lo < inside.hi) sum += strip(row, inside, stepping);
    }
    return sum;
  }

  [[nodiscard]] int cells_in(const Interval& v) const {
    const auto end = [&](double x) { return std::clamp(x, picture_.left_mm(), picture_.right_mm()); };
    const Interval a = section_.chord(v.lo), b = section_.chord(v.hi);
    double across = 0.0;
    if (!a.empty() && !b.empty()) {
      across = std::max(std::fabs(end(a.lo + apex_.x) - end(b.lo + apex_.x)),
                        std::fabs(end(a.hi + apex_.x) - end(b.hi + apex_.x)));
    }
    const double wanted = std::max(across * density_.per_mm_across, (v.hi - v.lo) * density_.per_mm_down);
    return static_cast<int>(std::clamp(std::ceil(wanted), 1.0, 1e6));
  }

  [[nodiscard]] double strip(int row, const Interval& v, const Stepping& stepping) const {
    constexpr double gauss = 0.28867513459481288225;  // 1 / sqrt(12): half the distance between two Gauss nodes
    const double from = stepping.t(v.lo);
    const int cells = cells_in(v);
    const double step = (stepping.t(v.hi) - from) / cells;
    double sum = 0.0;
    for (int cell = 0; cell < cells; ++cell) {
      for (const double node : {cell + 0.5 - gauss, cell + 0.5 + gauss}) {
        const double t = from + step * node;
        const Interval x = clipped_chord(stepping.v(t));
        if (x.lo < x.hi) sum += stepping.slope(t) * picture_.between(row, x.lo, x.hi);
      }
    }
    return 0.5 * std::fabs(step) * sum;
  }

  const PictureIntegral& picture_;
  const ConeSection& section_;
  const hal::Vec3& apex_;
  const CellDensity& density_;
};

}  // namespace

hal::Result<void> Optics::validate() const {
  return eye.validate()
      .and_then([&] { return object.validate(); })
      .and_then([&] { return profile.validate(); })
      .and_then([&]() -> hal::Result<void> {
        if (cells_per_pixel >= 1 && cells_per_pixel <= 1024) return {};
        return hal::fail(hal::ErrorCode::out_of_range, "optics.cells_per_pixel",
                         "is " + std::to_string(cells_per_pixel) + ", expected 1 to 1024");
      });
}

hal::Result<std::vector<double>> Optics::expose(const Scene& scene) const {
  TRY(validate());
  TRY(sim::validate(scene));
  const Surface& sheet = scene.surfaces.front();
  const PictureIntegral picture(sheet);
  const double front_mm = eye.radius_mm + eye.lens_height_mm;
  const double scene_z = front_mm + sheet.distance_mm.value_or(object.distance_mm);
  const double pixel_area = object.pixel_width_mm() * object.pixel_height_mm();
  const CellDensity density{std::max(cells_per_pixel / object.pixel_width_mm(), 1.0 / picture.pixel_width_mm()),
                            std::max(cells_per_pixel / object.pixel_height_mm(), 1.0 / picture.pixel_height_mm())};

  std::vector<double> signals(static_cast<std::size_t>(eye.ommatidia()), 0.0);
  for (int i = 0; i < eye.rows; ++i) {
    for (int k = 0; k < eye.columns; ++k) {
      const hal::Vec3 apex = eye.apex(i, k);
      const double depth = scene_z - apex.z;
      const double projection = (object.z_mm(eye) - apex.z) / depth;
      double area = 0.0;
      for (const Shell& shell : profile.shells) {
        const ConeSection section(eye.axis(i, k), shell.half_angle_rad, depth);
        area += shell.weight * SectionIntegral(picture, section, apex, density).value();
      }
      const auto m = static_cast<std::size_t>(i) * static_cast<std::size_t>(eye.columns) + static_cast<std::size_t>(k);
      signals[m] = area * projection * projection / pixel_area;
    }
  }
  return signals;
}

}  // namespace compueye::sim
