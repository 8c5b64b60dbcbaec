#include "sim/render/flat_section.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/render/cone_section.hpp"

namespace compueye::sim {
namespace {

struct Point {
  double u, v;  // mm from the foot of the apex
};

/// Q(u, v) = (axis d)^2 - cos^2 h |d|^2 on the plane: 0 on the edge, > 0 within.
struct Quadratic {
  double ax, ay, az, cosine2, depth, inverse_centre;

  Quadratic(const hal::Vec3& axis, double half_angle_rad, double depth_mm)
      : ax(axis.x), ay(axis.y), az(axis.z * depth_mm), depth(depth_mm) {
    const double sine2 = std::sin(half_angle_rad) * std::sin(half_angle_rad);
    cosine2 = 1.0 - sine2;
    inverse_centre = (axis.z * axis.z - sine2) / (depth * depth * cosine2 * sine2);
  }
};

/// One edge, left or right, of one section.
class Edge {
 public:
  Edge(const PictureSums& picture, const ConeSection& section, const ConeSection& turned, const Quadratic& quadratic,
       const hal::Vec3& apex, bool right, double tolerance)
      : picture_(picture),
        section_(section),
        turned_(turned),
        q_(quadratic),
        apex_(apex),
        right_(right),
        tolerance_(tolerance),
        inverse_width_(1.0 / picture.pixel_width_mm()) {}

  /// Integral dv of the running sum up to the edge, over a piece of it within one row, from the upper point to the
  /// lower one, along which it goes one way.
  [[nodiscard]] double piece(const double* sums, Point from, Point to) const {
    const int last = picture_.cols() - 1;
    int col = column(from.u);
    const int end = column(to.u);
    if (col == end) return within(sums, col, from, to);
    const bool rising = from.u > to.u;  // of u with v
    const bool upper = rising != right_;
    const int step = end > col ? 1 : -1;
    double sum = 0.0;
    for (; col != end; col += step) {
      const double u = picture_.left_mm() - apex_.x + (step > 0 ? col + 1 : col) * picture_.pixel_width_mm();
      const Interval v = turned_.chord(u);
      const Point next{u, std::clamp(v.empty() ? from.v : (upper ? v.hi : v.lo), to.v, from.v)};
      sum += col < 0 || col > last ? outside(sums, col, from.v - next.v) : within(sums, col, from, next);
      from = next;
    }
    return sum + within(sums, end, from, to);
  }

 private:
  /// -1 and cols: beyond the picture.
  [[nodiscard]] int column(double u) const {
    const double pixels = (u + apex_.x - picture_.left_mm()) * inverse_width_;
    if (!(pixels > 0.0)) return -1;
    return pixels >= picture_.cols() ? picture_.cols() : static_cast<int>(pixels);
  }

  [[nodiscard]] double outside(const double* sums, int col, double height) const {
    return col < 0 ? 0.0 : sums[picture_.cols()] * picture_.pixel_width_mm() * height;
  }

  [[nodiscard]] double within(const double* sums, int col, Point from, Point to) const {
    const double height = from.v - to.v;
    if (col < 0 || col >= picture_.cols()) return outside(sums, col, height);
    const double width = picture_.pixel_width_mm();
    const double value = sums[col + 1] - sums[col];
    const double u0 = picture_.left_mm() - apex_.x + col * width;
    const double whole = sums[col] * width * height;
    if (value == 0.0) return whole;
    const double bulging = value * bulge(from, to, 0);
    return whole + value * (0.5 * (from.u + to.u) - u0) * height + (right_ ? bulging : -bulging);
  }

  // Area between chord and edge. The gradient at the middle of a chord is perpendicular to it, so the edge is
  // Q / |grad Q| off; that every conic is a circle seen askew gives the next term, by Q at its centre.
  [[nodiscard]] double bulge(Point from, Point to, int depth) const {
    const double du = to.u - from.u, dv = to.v - from.v;
    const double um = 0.5 * (from.u + to.u), vm = 0.5 * (from.v + to.v);
    const double along = q_.ax * du + q_.ay * dv;
    const double length2 = du * du + dv * dv;
    const double middle = 0.25 * (q_.cosine2 * length2 - along * along);
    const double axial = q_.ax * um + q_.ay * vm + q_.az;
    const double gradient_u = 2.0 * (q_.ax * axial - q_.cosine2 * um);
    const double gradient_v = 2.0 * (q_.ay * axial - q_.cosine2 * vm);
    const double across = std::fabs(du * gradient_v - dv * gradient_u);
    if (!(across > 0.0)) return 0.0;
    const double first = 2.0 / 3.0 * middle * length2 / across;
    const double share = middle * q_.inverse_centre;
    if (first * share * share < tolerance_ || depth > 40) return first * (1.0 - 0.2 * share);
    const Point half = between(from, to);
    const double triangle = 0.5 * std::fabs(du * (half.v - from.v) - dv * (half.u - from.u));
    return triangle + bulge(from, half, depth + 1) + bulge(half, to, depth + 1);
  }

  /// A point of the edge between two.
  [[nodiscard]] Point between(Point from, Point to) const {
    const double um = 0.5 * (from.u + to.u), vm = 0.5 * (from.v + to.v);
    if (std::fabs(to.u - from.u) > std::fabs(to.v - from.v)) {
      const bool upper = (from.u > to.u) != right_;
      const Interval v = turned_.chord(um);
      return {um, v.empty() ? vm : (upper ? v.hi : v.lo)};
    }
    const Interval u = section_.chord(vm);
    return {u.empty() ? um : (right_ ? u.hi : u.lo), vm};
  }

  const PictureSums& picture_;
  const ConeSection &section_, &turned_;
  const Quadratic& q_;
  const hal::Vec3& apex_;
  bool right_;
  double tolerance_, inverse_width_;
};

/// Middle of the chord at an end of a region, stepping inwards from where rounding leaves none.
double touching(const ConeSection& section, double end, const Interval& range) {
  const Interval chord = section.chord(end);
  if (!chord.empty()) return 0.5 * (chord.lo + chord.hi);
  const double size = std::isfinite(range.lo) && std::isfinite(range.hi) ? range.hi - range.lo : std::fabs(end) + 1.0;
  const Interval inner = section.chord(end + (end == range.lo ? 1e-12 : -1e-12) * size);
  return inner.empty() ? 0.0 : 0.5 * (inner.lo + inner.hi);
}

}  // namespace

double light_in_section(const PictureSums& picture, const hal::Vec3& apex, const hal::Vec3& axis, double half_angle_rad,
                        double tolerance_mm2) noexcept {
  const double depth = -apex.z, pixel_height = picture.pixel_height_mm(), top = picture.top_mm() - apex.y;
  const ConeSection section(axis, half_angle_rad, depth);
  const ConeSection turned({axis.y, axis.x, axis.z}, half_angle_rad, depth);
  const Interval us = section.u_range(), vs = section.v_range();
  if (us.empty() || vs.empty()) return 0.0;
  if (us.hi + apex.x <= picture.left_mm() || us.lo + apex.x >= -picture.left_mm()) return 0.0;
  const double upper = std::min(vs.hi, top), lower = std::max(vs.lo, top - picture.rows() * pixel_height);
  if (!(lower < upper)) return 0.0;

  const Quadratic quadratic(axis, half_angle_rad, depth);
  const Edge left(picture, section, turned, quadratic, apex, false, tolerance_mm2);
  const Edge right(picture, section, turned, quadratic, apex, true, tolerance_mm2);
  const double turn_left = std::isfinite(us.lo) ? touching(turned, us.lo, us) : upper;
  const double turn_right = std::isfinite(us.hi) ? touching(turned, us.hi, us) : upper;
  const double far = 4.0 * (std::fabs(picture.left_mm()) + std::fabs(apex.x) + depth);
  const auto chord_at = [&](double v) {
    Interval chord = section.chord(v);
    if (chord.empty()) {
      const double u = touching(section, v, vs);
      chord = {u, u};
    }
    return Interval{std::clamp(chord.lo, -far, far), std::clamp(chord.hi, -far, far)};
  };

  const auto row_of = [&](double v) {
    return std::clamp(static_cast<int>((top - v) / pixel_height), 0, picture.rows() - 1);
  };
  double sum = 0.0, v = upper;
  Interval chord = chord_at(v);
  for (int row = row_of(upper), last = row_of(lower); row <= last; ++row) {
    const double next = row == last ? lower : std::max(lower, top - (row + 1) * pixel_height);
    const Interval below = chord_at(next);
    if (!picture.black(row) && next < v) {
      const double* sums = picture.row_sums(row);
      if (turn_right < v && turn_right > next) {
        const Point turn{std::min(us.hi, far), turn_right};
        sum += right.piece(sums, {chord.hi, v}, turn) + right.piece(sums, turn, {below.hi, next});
      } else {
        sum += right.piece(sums, {chord.hi, v}, {below.hi, next});
      }
      if (turn_left < v && turn_left > next) {
        const Point turn{std::max(us.lo, -far), turn_left};
        sum -= left.piece(sums, {chord.lo, v}, turn) + left.piece(sums, turn, {below.lo, next});
      } else {
        sum -= left.piece(sums, {chord.lo, v}, {below.lo, next});
      }
    }
    chord = below;
    v = next;
  }
  return sum;
}

}  // namespace compueye::sim
