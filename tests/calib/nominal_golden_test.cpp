// Figures of the paper's geometry, and of eyes derived from it, that an independent model of the optics gave.
#include <doctest/doctest.h>

#include <cmath>

#include "calib/nominal.hpp"
#include "calib/response_summary.hpp"
#include "tests/calib/cone_reference.hpp"

using namespace compueye;
using namespace compueye::calib;
using hal::EyeGeometry;
using hal::Lattice;
using hal::ObjectPlane;
using reference::deg;

namespace {

EyeGeometry square_eye(int n, double interommatidial_deg, double acceptance_deg, Lattice lattice = Lattice::fisheye) {
  EyeGeometry eye;
  eye.lattice = lattice;
  eye.rows = eye.columns = n;
  eye.interommatidial_rad = interommatidial_deg * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  return eye;
}

constexpr ObjectPlane figure_2_plane{16, 16, 8.0, 8.0, 30.0};
constexpr ObjectPlane large_plane{160, 160, 60.0, 60.0, 10.0};

ResponseSummary summary_of(const EyeGeometry& eye, const ObjectPlane& plane) {
  const auto response = nominal_response(eye, plane);
  REQUIRE(response.has_value());
  return summarise(*response);
}

}  // namespace

TEST_CASE("golden: 8x8 at 8 deg, the largest receptive field touches 76 pixels, 52 by half, 40 wholly") {
  const auto response = nominal_response(square_eye(8, 1.5, 8.0), figure_2_plane);
  REQUIRE(response.has_value());
  int touched = 0, half = 0, whole = 0;
  for (int m = 0; m < 64; ++m) {
    int row_touched = 0, row_half = 0, row_whole = 0;
    response->for_each_in_row(m, [&](std::int32_t, double v) {
      ++row_touched;
      if (v > 0.5) ++row_half;
      if (v == 1.0) ++row_whole;
    });
    if (row_touched > touched) {
      touched = row_touched;
      half = row_half;
      whole = row_whole;
    }
  }
  CHECK(touched == 76);
  CHECK(half == 52);
  CHECK(whole == 40);
}

TEST_CASE("golden: 8x8 at 1.5 deg, every ommatidium touches 4 pixels and no pixel is seen twice") {
  const ResponseSummary s = summary_of(square_eye(8, 1.5, 1.5), figure_2_plane);
  CHECK(s.blind_rows == 0);
  CHECK(s.support_min == 4);
  CHECK(s.support_max == 4);
  CHECK(s.most_seen == 1);
  CHECK(s.seen_pixels == 256);
}

TEST_CASE("golden: the receptive field at 8 deg has 28.53 times the area of that at 1.5 deg") {
  // The ommatidium that looks straight ahead, which an odd lattice has.
  const double wide = section_of(square_eye(9, 1.5, 8.0), figure_2_plane, 4, 4).area_mm2();
  const double narrow = section_of(square_eye(9, 1.5, 1.5), figure_2_plane, 4, 4).area_mm2();
  CHECK(std::round(100.0 * wide / narrow) == 2853.0);
}

TEST_CASE("golden: neighbours of the 80x80 eye look 0.7179 mm apart at 10 mm") {
  const EyeGeometry eye = square_eye(81, 2.25, 60.0);
  const hal::Vec3 apex = eye.apex(40, 41), axis = eye.axis(40, 41);
  const double apart = apex.x + (large_plane.z_mm(eye) - apex.z) * axis.x / axis.z;
  CHECK(std::round(1e4 * apart) == 7179.0);
}

TEST_CASE("golden: 80x80 at 60 deg has 9,010,124 entries, 1836 blind rows and supports 6 / 1973 / 4050") {
  const ResponseSummary s = summary_of(square_eye(80, 2.25, 60.0), large_plane);
  CHECK(s.entries == doctest::Approx(9010124).epsilon(1e-4));
  CHECK(s.blind_rows == 1836);
  CHECK(s.support_min == 6);
  CHECK(s.support_median == doctest::Approx(1973).epsilon(1e-3));
  CHECK(s.support_max == 4050);
}

TEST_CASE("golden: 120x120 at 60 deg has 20,273,128 entries and 4084 blind rows") {
  const ResponseSummary s = summary_of(square_eye(120, 1.5, 60.0), large_plane);
  CHECK(s.entries == doctest::Approx(20273128).epsilon(1e-4));
  CHECK(s.blind_rows == 4084);
}

TEST_CASE("golden: 80x80 at 60 deg, azimuth-elevation lattice, has 9.92e6 entries and 1176 blind rows") {
  const ResponseSummary s = summary_of(square_eye(80, 2.25, 60.0, Lattice::azimuth_elevation), large_plane);
  CHECK(std::round(static_cast<double>(s.entries) / 1e4) == 992.0);
  CHECK(s.blind_rows == 1176);
}

TEST_CASE("golden: 80x80 at 60 deg, tangent lattice, has 10.74e6 entries and 1024 blind rows") {
  const ResponseSummary s = summary_of(square_eye(80, 2.25, 60.0, Lattice::tangent), large_plane);
  CHECK(std::round(static_cast<double>(s.entries) / 1e4) == 1074.0);
  CHECK(s.blind_rows == 1024);
}

TEST_CASE("golden: 100x100 at 60 deg and 5, 10, 15 mm has 7.71, 14.08 and 17.63 million entries") {
  const EyeGeometry eye = square_eye(100, 1.8, 60.0);
  CHECK(summary_of(eye, {160, 160, 30.0, 30.0, 5.0}).entries == doctest::Approx(7709188).epsilon(1e-4));
  CHECK(summary_of(eye, {160, 160, 60.0, 60.0, 10.0}).entries == doctest::Approx(14079640).epsilon(1e-4));
  CHECK(summary_of(eye, {160, 160, 90.0, 90.0, 15.0}).entries == doctest::Approx(17630936).epsilon(1e-4));
}

TEST_CASE("golden: the conventional 80x80 eye has 25,392 entries, 4012 blind rows and 1800 unseen pixels") {
  const ResponseSummary s = summary_of(square_eye(80, 2.25, 2.25), large_plane);
  CHECK(s.entries == 25392);
  CHECK(s.blind_rows == 4012);
  CHECK(s.unseen_pixels() == 1800);
}
