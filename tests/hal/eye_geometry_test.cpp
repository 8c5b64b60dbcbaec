#include "hal/eye_geometry.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace compueye::hal;

TEST_CASE("every lattice has unit axes and looks ahead in its middle") {
  for (const Lattice lattice :
       {Lattice::fisheye, Lattice::azimuth_elevation, Lattice::tangent, Lattice::plane, Lattice::cylinder}) {
    CAPTURE(name(lattice));
    EyeGeometry eye;
    eye.lattice = lattice;
    eye.rows = 9;
    eye.columns = 11;
    eye.interommatidial_rad = 4.0 * std::numbers::pi / 180.0;
    eye.acceptance_rad = 10.0 * std::numbers::pi / 180.0;
    eye.pitch_mm = 0.2;
    REQUIRE(eye.validate().has_value());
    for (int i = 0; i < eye.rows; ++i) {
      for (int k = 0; k < eye.columns; ++k) {
        const Vec3 d = eye.axis(i, k);
        CHECK(std::hypot(d.x, d.y, d.z) == doctest::Approx(1.0).epsilon(1e-14));
      }
    }
    CHECK(eye.axis(4, 5).z == doctest::Approx(1.0));
    CHECK(eye.apex(4, 5).z == doctest::Approx(eye.radius_mm + eye.lens_height_mm));
    CHECK(lattice_from_name(name(lattice)).value() == lattice);
  }
}
