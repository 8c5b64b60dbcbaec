#include "calib/estimate/soft_cone.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "calib/nominal.hpp"
#include "calib/pixel_grid.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using calib::ConeParameters;
using calib::ConeRow;
using calib::SoftCone;

namespace {

using compueye::test::deg;

hal::EyeGeometry eye_of(int n, double interommatidial_deg, double acceptance_deg) {
  hal::EyeGeometry eye;
  eye.rows = eye.columns = n;
  eye.interommatidial_rad = interommatidial_deg * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  return eye;
}

const hal::EyeGeometry small_eye = eye_of(8, 1.5, 8.0), large_eye = eye_of(20, 6.0, 60.0),
                       narrow_eye = eye_of(8, 1.5, 1.5);
constexpr hal::ObjectPlane small_plane{16, 16, 8.0, 8.0, 30.0}, large_plane{48, 48, 60.0, 60.0, 10.0};

/// The same profile as a stack of exact sections (cone_section.hpp, pixel_coverage.hpp), which share no code with
/// SoftCone.
std::vector<double> exact_row(const hal::EyeGeometry& eye, const hal::ObjectPlane& plane, int i, int k,
                              const ConeParameters& cone) {
  constexpr int shells = 400;
  calib::PixelGrid grid(plane);
  std::vector<double> row(static_cast<std::size_t>(plane.pixels()), 0.0);
  for (int s = 0; s < shells; ++s) {
    const double half = cone.half_angle_rad * std::pow(-std::log2((s + 0.5) / shells), 1.0 / cone.order);
    const calib::ConeSection section(eye.apex(i, k), eye.axis(i, k), half, plane.z_mm(eye));
    grid.for_each_covered(section, [&](std::int32_t n, double a) { row[static_cast<std::size_t>(n)] += a / shells; });
  }
  return row;
}

std::vector<double> dense(const ConeRow& row, int pixels) {
  std::vector<double> all(static_cast<std::size_t>(pixels), 0.0);
  for (std::size_t j = 0; j < row.size(); ++j) all[static_cast<std::size_t>(row.pixels[j])] = row.covered[j];
  return all;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0.0, size = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    squares += (a[n] - b[n]) * (a[n] - b[n]);
    size += b[n] * b[n];
  }
  return std::sqrt(squares / size);
}

}  // namespace

TEST_CASE("calib: a soft cone covers what exact sections cover, from hard edges to soft ones") {
  struct Case {
    const hal::EyeGeometry& eye;
    const hal::ObjectPlane& plane;
    int i, k;
    double order, within;
  };
  for (const Case& c : {Case{small_eye, small_plane, 3, 4, 300.0, 3e-3}, Case{small_eye, small_plane, 0, 0, 8.0, 2e-3},
                        Case{small_eye, small_plane, 5, 2, 2.0, 3e-3}, Case{large_eye, large_plane, 10, 9, 8.0, 2e-3},
                        Case{large_eye, large_plane, 3, 5, 8.0, 4e-3}, Case{large_eye, large_plane, 10, 1, 30.0, 4e-3},
                        Case{narrow_eye, small_plane, 4, 3, 8.0, 5e-3}}) {
    CAPTURE(c.i);
    CAPTURE(c.order);
    SoftCone model(c.eye, c.plane);
    ConeParameters cone = model.drawn();
    cone.order = c.order;
    ConeRow row;
    model.expose(c.i, c.k, cone, {}, row);
    CHECK(std::is_sorted(row.pixels.begin(), row.pixels.end()));
    CHECK(apart(dense(row, c.plane.pixels()), exact_row(c.eye, c.plane, c.i, c.k, cone)) < c.within);
  }
}

TEST_CASE("calib: the changes of a soft cone are its differences") {
  SoftCone model(large_eye, large_plane);
  ConeParameters cone = model.drawn();
  cone.tilt_one_rad = 0.01;
  cone.tilt_other_rad = -0.02;
  ConeRow row;
  model.expose(6, 12, cone, {}, row);
  const auto changed = [&](int d, double step) {
    ConeParameters moved = cone;
    if (d == 0) moved.tilt_one_rad += step;
    if (d == 1) moved.tilt_other_rad += step;
    if (d == 2) moved.half_angle_rad *= std::exp(step);
    if (d == 3) moved.order *= std::exp(step);
    ConeRow other;
    model.expose(6, 12, moved, {}, other);
    return dense(other, large_plane.pixels());
  };
  for (int d = 0; d < 4; ++d) {
    CAPTURE(d);
    const double step = d < 2 ? 2e-4 : 2e-3;
    const std::vector<double> more = changed(d, step), less = changed(d, -step);
    std::vector<double> difference(more.size()), told(more.size(), 0.0);
    for (std::size_t n = 0; n < more.size(); ++n) difference[n] = (more[n] - less[n]) / (2.0 * step);
    for (std::size_t j = 0; j < row.size(); ++j) {
      told[static_cast<std::size_t>(row.pixels[j])] = row.change[static_cast<std::size_t>(d)][j];
    }
    CHECK(apart(told, difference) < 0.03);
  }
}

TEST_CASE("calib: a display that is farther is the one drawn farther") {
  SoftCone model(small_eye, small_plane);
  hal::ObjectPlane farther = small_plane;
  farther.distance_mm += 2.0;
  SoftCone other(small_eye, farther);
  ConeRow moved, drawn;
  model.expose(1, 6, model.drawn(), {2.0, 0.0, 0.0}, moved);
  other.expose(1, 6, other.drawn(), {}, drawn);
  CHECK(apart(dense(moved, 256), dense(drawn, 256)) < 1e-12);
}

TEST_CASE("calib: on a display that is turned, cones look where their axes meet it") {
  constexpr hal::ObjectPlane fine{64, 64, 8.0, 8.0, 30.0};
  SoftCone model(narrow_eye, fine);
  for (const calib::PlaneError& turned : {calib::PlaneError{0.5, 0.15, 0.0}, calib::PlaneError{0.0, 0.0, -0.2}}) {
    // The display's right and up, after the lean about x and then the tilt about y.
    const double cl = std::cos(turned.lean_rad), sl = std::sin(turned.lean_rad);
    const double ct = std::cos(turned.tilt_rad), st = std::sin(turned.tilt_rad);
    const hal::Vec3 right{ct, 0.0, st}, up{-sl * st, cl, sl * ct};
    const hal::Vec3 normal{-cl * st, -sl, cl * ct};
    const double centre_z = fine.z_mm(narrow_eye) + turned.distance_mm;
    const hal::Vec3 apex = narrow_eye.apex(1, 6), axis = narrow_eye.axis(1, 6);
    const hal::Vec3 to_centre{-apex.x, -apex.y, centre_z - apex.z};
    const double t = (normal.x * to_centre.x + normal.y * to_centre.y + normal.z * to_centre.z) /
                     (normal.x * axis.x + normal.y * axis.y + normal.z * axis.z);
    const hal::Vec3 hit{t * axis.x - to_centre.x, t * axis.y - to_centre.y, t * axis.z - to_centre.z};
    ConeRow row;
    model.expose(1, 6, model.drawn(), turned, row);
    double light = 0.0, x = 0.0, y = 0.0;
    for (std::size_t j = 0; j < row.size(); ++j) {
      light += row.covered[j];
      x += row.covered[j] * ((row.pixels[j] % 64 + 0.5) / 64.0 - 0.5) * 8.0;
      y += row.covered[j] * (0.5 - (row.pixels[j] / 64 + 0.5) / 64.0) * 8.0;
    }
    CHECK(x / light == doctest::Approx(hit.x * right.x + hit.y * right.y + hit.z * right.z).epsilon(2e-3));
    CHECK(y / light == doctest::Approx(hit.x * up.x + hit.y * up.y + hit.z * up.z).epsilon(2e-3));
  }
}

TEST_CASE("calib: a cone that looks past the display covers nothing") {
  hal::EyeGeometry eye = eye_of(20, 9.0, 8.0);
  SoftCone model(eye, small_plane);
  ConeRow row;
  model.expose(0, 10, model.drawn(), {}, row);
  CHECK(row.size() == 0);
  model.expose(0, 0, model.drawn(), {}, row);
  CHECK(row.size() == 0);
}
