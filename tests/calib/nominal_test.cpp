#include "calib/nominal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "tests/calib/cone_reference.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::calib;
using hal::EyeGeometry;
using hal::Lattice;
using hal::ObjectPlane;
using reference::deg;

namespace {

EyeGeometry small_eye(Lattice lattice, double acceptance_deg) {
  EyeGeometry eye;
  eye.lattice = lattice;
  eye.rows = 6;
  eye.columns = 7;
  eye.interommatidial_rad = 11.0 * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  eye.pitch_mm = 1.5;
  return eye;
}

constexpr ObjectPlane small_plane{24, 30, 40.0, 32.0, 10.0};

std::vector<double> dense(const recon::Response& a) {
  std::vector<double> values(static_cast<std::size_t>(a.rows()) * static_cast<std::size_t>(a.cols()), 0.0);
  for (int m = 0; m < a.rows(); ++m) {
    a.for_each_in_row(m, [&](std::int32_t j, double v) {
      values[static_cast<std::size_t>(m) * static_cast<std::size_t>(a.cols()) + static_cast<std::size_t>(j)] = v;
    });
  }
  return values;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

}  // namespace

TEST_CASE("every entry of every lattice agrees with sampling of the cones") {
  constexpr int n = 12;
  for (const Lattice lattice :
       {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
    CAPTURE(hal::name(lattice));
    const EyeGeometry eye = small_eye(lattice, 70.0);
    const ObjectPlane plane{12, 15, 40.0, 32.0, 10.0};
    const auto response = nominal_response(eye, plane);
    REQUIRE(response.has_value());
    REQUIRE(response->rows() == 42);
    REQUIRE(response->cols() == 180);
    const std::vector<double> a = dense(*response);
    double worst = 0.0, total = 0.0, sampled_total = 0.0;
    for (int m = 0; m < eye.ommatidia(); ++m) {
      const int i = m / eye.columns, k = m % eye.columns;
      const reference::Cone cone{eye.apex(i, k), eye.axis(i, k), eye.acceptance_rad / 2.0, plane.z_mm(eye)};
      for (int j = 0; j < plane.pixels(); ++j) {
        const int r = j / plane.cols, c = j % plane.cols;
        const double w = plane.pixel_width_mm(), h = plane.pixel_height_mm();
        const double left = -plane.width_mm / 2.0 + c * w, top = plane.height_mm / 2.0 - r * h;
        const double sampled = reference::sampled_coverage(cone, {left, left + w, top - h, top}, n);
        const double exact = a[static_cast<std::size_t>(m * plane.pixels() + j)];
        worst = std::max(worst, std::abs(exact - sampled));
        total += exact;
        sampled_total += sampled;
      }
    }
    CHECK(worst <= 2.0 / n);
    CHECK(total == doctest::Approx(sampled_total).epsilon(2e-3));
  }
}

TEST_CASE("only lengths relative to each other matter") {
  for (const double acceptance_deg : {3.0, 60.0, 120.0}) {
    EyeGeometry eye = small_eye(Lattice::fisheye, acceptance_deg);
    ObjectPlane plane = small_plane;
    const auto one = nominal_response(eye, plane);
    constexpr double scale = 7.3;
    eye.radius_mm *= scale;
    eye.lens_height_mm *= scale;
    plane.width_mm *= scale;
    plane.height_mm *= scale;
    plane.distance_mm *= scale;
    const auto scaled = nominal_response(eye, plane);
    REQUIRE(one.has_value());
    REQUIRE(scaled.has_value());
    CHECK(largest_difference(dense(*one), dense(*scaled)) <= 1e-11);
  }
}

TEST_CASE("a mirrored lattice sees a mirrored picture") {
  for (const Lattice lattice :
       {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
    CAPTURE(hal::name(lattice));
    for (const double acceptance_deg : {2.0, 45.0, 120.0}) {
      CAPTURE(acceptance_deg);
      const EyeGeometry eye = small_eye(lattice, acceptance_deg);
      const auto response = nominal_response(eye, small_plane);
      REQUIRE(response.has_value());
      const std::vector<double> a = dense(*response);
      const auto at = [&](int i, int k, int r, int c) {
        return a[static_cast<std::size_t>((i * eye.columns + k) * small_plane.pixels() + r * small_plane.cols + c)];
      };
      double across = 0.0, upside_down = 0.0;
      for (int i = 0; i < eye.rows; ++i) {
        for (int k = 0; k < eye.columns; ++k) {
          for (int r = 0; r < small_plane.rows; ++r) {
            for (int c = 0; c < small_plane.cols; ++c) {
              const double v = at(i, k, r, c);
              const double flipped = at(i, eye.columns - 1 - k, r, small_plane.cols - 1 - c);
              const double turned = at(eye.rows - 1 - i, k, small_plane.rows - 1 - r, c);
              across = std::max(across, std::abs(v - flipped));
              upside_down = std::max(upside_down, std::abs(v - turned));
            }
          }
        }
      }
      CHECK(across <= 1e-12);
      CHECK(upside_down <= 1e-12);
    }
  }
}

TEST_CASE("a section wholly on the plane is counted with its whole area") {
  // The plane is made large enough for every ellipse; rows then add up to pi a b.
  for (const double acceptance_deg : {0.001, 0.5, 8.0, 60.0}) {
    CAPTURE(acceptance_deg);
    EyeGeometry eye = small_eye(Lattice::fisheye, acceptance_deg);
    eye.interommatidial_rad = 5.0 * deg;
    const ObjectPlane plane{90, 110, 120.0, 100.0, 10.0};
    const auto response = nominal_response(eye, plane);
    REQUIRE(response.has_value());
    const std::vector<double> sums = response->row_sums();
    for (int m = 0; m < eye.ommatidia(); ++m) {
      const ConeSection s = section_of(eye, plane, m / eye.columns, m % eye.columns);
      REQUIRE(s.kind() == SectionKind::ellipse);
      REQUIRE(s.vertex_x_mm() + s.x_extent().hi < plane.width_mm / 2.0);
      const double area = sums[static_cast<std::size_t>(m)] * plane.pixel_width_mm() * plane.pixel_height_mm();
      // A cone below a pixel loses entries under 1e-13 where it straddles a border.
      CHECK(std::abs(area - s.area_mm2()) <= 1e-9 * s.area_mm2());
    }
  }
}

TEST_CASE("the row sum is the clipped area whatever the pixels, for any eye") {
  reference::Random random(8);
  double worst = 0.0, brightest = 0.0;
  for (int n = 0; n < 400; ++n) {
    EyeGeometry eye;
    eye.lattice = static_cast<Lattice>(n % 5);
    eye.rows = 1 + static_cast<int>(random.uniform(0.0, 5.0));
    eye.columns = 1 + static_cast<int>(random.uniform(0.0, 5.0));
    eye.interommatidial_rad = random.log_uniform(0.1, eye.lattice == Lattice::tangent ? 44.0 : 89.0) * deg;
    eye.acceptance_rad = n % 9 == 0 ? 120.0 * deg : random.log_uniform(0.01, 120.0) * deg;
    eye.radius_mm = n % 4 == 0 ? 0.0 : random.log_uniform(0.1, 100.0);
    eye.pitch_mm = random.log_uniform(0.1, 5.0);
    ObjectPlane plane{1, 1, random.log_uniform(0.1, 100.0), random.log_uniform(0.1, 100.0),
                      random.log_uniform(1e-3, 1e3)};
    CAPTURE(n);
    const auto coarse = nominal_response(eye, plane);
    plane.rows = 1 + static_cast<int>(random.uniform(0.0, 40.0));
    plane.cols = 1 + static_cast<int>(random.uniform(0.0, 40.0));
    const auto fine = nominal_response(eye, plane);
    REQUIRE(coarse.has_value());
    REQUIRE(fine.has_value());
    const std::vector<double> one = coarse->row_sums(), many = fine->row_sums();
    for (std::size_t m = 0; m < one.size(); ++m) {
      worst = std::max(worst, std::abs(many[m] / plane.pixels() - one[m]));
      brightest = std::max(brightest, one[m]);
    }
  }
  CHECK(worst <= 1e-11);
  CHECK(brightest == 1.0);
}

TEST_CASE("pixels wholly inside are exactly one and all others lie between") {
  const auto response = nominal_response(small_eye(Lattice::fisheye, 90.0), small_plane);
  REQUIRE(response.has_value());
  std::int64_t ones = 0, between = 0;
  for (const double v : response->values()) {
    CHECK(v > negligible_coverage);
    CHECK(v <= 1.0);
    ++(v == 1.0 ? ones : between);
  }
  CHECK(ones > 0);
  CHECK(between > 0);

  EyeGeometry close = small_eye(Lattice::fisheye, 120.0);
  close.rows = close.columns = 1;
  const auto all = nominal_response(close, {20, 30, 8.0, 6.0, 10.0});
  REQUIRE(all.has_value());
  CHECK(all->stored_entries() == 600);
  CHECK(all->row_sums().front() == 600.0);
}

TEST_CASE("a section that passes exactly through pixel corners is exact there too") {
  // One upright cone over the centre: a circle through the four corners of the 2 x 2 middle pixels, which touches
  // their outer neighbours in a segment, and its quarter turns are the same.
  EyeGeometry eye;
  eye.rows = eye.columns = 1;
  eye.interommatidial_rad = 1.0 * deg;
  eye.acceptance_rad = 2.0 * std::atan(std::numbers::sqrt2 / 10.0);
  const auto response = nominal_response(eye, {4, 4, 4.0, 4.0, 10.0});
  REQUIRE(response.has_value());
  const std::vector<double> a = dense(*response);
  const double segment = (std::numbers::pi / 2.0 - 1.0) / 2.0;  // of radius sqrt 2 over a quarter, half of it a pixel
  for (const int inner : {5, 6, 9, 10})
    CHECK(a[static_cast<std::size_t>(inner)] == doctest::Approx(1.0).epsilon(1e-13));
  for (const int side : {1, 2, 4, 7, 8, 11, 13, 14}) {
    CHECK(a[static_cast<std::size_t>(side)] == doctest::Approx(segment).epsilon(1e-12));
  }
  for (const int corner : {0, 3, 12, 15}) CHECK(a[static_cast<std::size_t>(corner)] < 1e-12);

  // And one that touches the borders of the plane from inside.
  eye.acceptance_rad = 2.0 * std::atan(0.2);
  const auto inscribed = nominal_response(eye, {4, 4, 4.0, 4.0, 10.0});
  REQUIRE(inscribed.has_value());
  CHECK(inscribed->row_sums().front() == doctest::Approx(4.0 * std::numbers::pi).epsilon(1e-13));
}

TEST_CASE("an eye almost on the plane, of no radius, or narrower than a pixel is still exact") {
  EyeGeometry eye = small_eye(Lattice::fisheye, 60.0);
  eye.rows = eye.columns = 9;
  eye.interommatidial_rad = 2.0 * deg;
  ObjectPlane plane{9, 9, 9.0, 9.0, 1e-6};
  const auto near = nominal_response(eye, plane);
  REQUIRE(near.has_value());
  // The middle ommatidium, its lens a nanometre from the plane: a circle of radius 1e-6 tan 30 deg in one pixel.
  const double radius = 1e-6 * std::tan(30.0 * deg);
  CHECK(near->row_sums()[40] == doctest::Approx(std::numbers::pi * radius * radius).epsilon(1e-8));

  eye.radius_mm = eye.lens_height_mm = 0.0;
  plane.distance_mm = 5.0;
  const auto point = nominal_response(eye, plane);
  REQUIRE(point.has_value());
  CHECK(point->row_sums()[40] == doctest::Approx(std::numbers::pi * 25.0 / 3.0).epsilon(1e-13));

  eye.acceptance_rad = 1e-4 * deg;
  const auto narrow = nominal_response(eye, plane);
  REQUIRE(narrow.has_value());
  const double spot = 5.0 * std::tan(0.5e-4 * deg);
  CHECK(narrow->row_sums()[40] == doctest::Approx(std::numbers::pi * spot * spot).epsilon(1e-9));
}

TEST_CASE("ommatidia that look away are blind rows, not missing ones") {
  EyeGeometry eye = small_eye(Lattice::fisheye, 20.0);
  eye.rows = eye.columns = 9;
  eye.interommatidial_rad = 40.0 * deg;  // up to 226 deg off the front
  const auto response = nominal_response(eye, small_plane);
  REQUIRE(response.has_value());
  CHECK(response->rows() == 81);
  CHECK(response->seeing_rows().size() < 81);
  const std::vector<double> sums = response->row_sums();
  for (int m = 0; m < 81; ++m) {
    const double cosine = eye.axis(m / 9, m % 9).z;
    if (cosine <= -std::sin(10.0 * deg)) CHECK(sums[static_cast<std::size_t>(m)] == 0.0);
  }
  CHECK(sums[40] > 0.0);
}

TEST_CASE("the nominal response refuses what is not an eye, and says which value") {
  const auto refused = [](const EyeGeometry& eye, const ObjectPlane& plane, const char* place,
                          const test::Named& named) {
    test::check_error(nominal_response(eye, plane), hal::ErrorCode::out_of_range, place, named);
  };
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  const EyeGeometry good = small_eye(Lattice::fisheye, 60.0);
  EyeGeometry eye = good;
  eye.acceptance_rad = 121.0 * deg;
  refused(eye, small_plane, "eye.acceptance_angle_deg", {"121", "120"});
  eye.acceptance_rad = not_a_number;
  refused(eye, small_plane, "eye.acceptance_angle_deg", {"nan", "120"});
  eye = good;
  eye.rows = 0;
  refused(eye, small_plane, "eye.rows", {"0", "1", "4096"});
  ObjectPlane plane = small_plane;
  plane.distance_mm = 0.0;
  refused(good, plane, "object.distance_mm", {"0"});
  plane.distance_mm = -2.5;
  refused(good, plane, "object.distance_mm", {"-2.5"});
  plane.distance_mm = not_a_number;
  refused(good, plane, "object.distance_mm", {"nan"});
  eye = good;
  eye.radius_mm = 1e20;
  refused(eye, small_plane, "object.distance_mm", {"10", "100000000000000000000"});
  eye.radius_mm = std::numeric_limits<double>::max();
  eye.lens_height_mm = std::numeric_limits<double>::max();
  refused(eye, small_plane, "object.distance_mm", {"10", std::to_string(eye.radius_mm)});
}

TEST_CASE("a response beyond the limit is refused by its size before it is computed") {
  const EyeGeometry eye = small_eye(Lattice::fisheye, 120.0);
  const auto response = nominal_response(eye, {8192, 8192, 8.0, 8.0, 10.0});
  test::check_error(response, hal::ErrorCode::no_space, "nominal response",
                    {std::to_string(nominal_response_limit_bytes >> 30)});
}

TEST_CASE("progress runs to its total, and can give up") {
  const EyeGeometry eye = small_eye(Lattice::fisheye, 60.0);
  double last = 0.0, total = 0.0;
  int stages = 0;
  std::string stage;
  const auto done = nominal_response(eye, small_plane, [&](std::string_view what, double at, double of) {
    if (what != stage) {
      stage = what;
      last = 0.0;
      ++stages;
    }
    CHECK(at > last);
    last = at;
    total = of;
    return true;
  });
  REQUIRE(done.has_value());
  CHECK(stages == 2);
  CHECK(last == total);

  int calls = 0;
  const auto stopped =
      nominal_response(eye, small_plane, [&](std::string_view, double, double) { return ++calls < 8; });
  REQUIRE_FALSE(stopped.has_value());
  CHECK(stopped.error().code == hal::ErrorCode::interrupted);
  CHECK(calls == 8);
}
