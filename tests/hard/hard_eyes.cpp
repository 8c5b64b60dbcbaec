#include "tests/hard/hard_eyes.hpp"
#include "tests/hal/units.hpp"

#include <numbers>
#include <utility>
#include <vector>

#include "calib/nominal.hpp"
#include "calib/plausible_response.hpp"
#include "hal/eye_geometry.hpp"
#include "tests/recon/random_problem.hpp"

namespace compueye::tests {
namespace {

using hal::Lattice;
using recon::Response;

using compueye::test::deg;

hal::EyeGeometry geometry(double acceptance_deg, double between_deg = 2.5, Lattice lattice = Lattice::fisheye) {
  hal::EyeGeometry eye;
  eye.lattice = lattice;
  eye.rows = eye.columns = 5;
  eye.interommatidial_rad = between_deg * deg;
  eye.acceptance_rad = acceptance_deg * deg;
  eye.pitch_mm = lattice == Lattice::plane || lattice == Lattice::cylinder ? 1.5 : 0.0;
  return eye;
}

hal::ObjectPlane plane_of(int rows, int cols) {
  return {rows, cols, 8.0, 8.0, 30.0};
}

Response seen_by(const hal::EyeGeometry& eye, int rows = 8, int cols = 8) {
  return calib::nominal_response(eye, plane_of(rows, cols)).value().with_image(rows, cols).value();
}

Response dense(int rows, int image_rows, int image_cols, std::vector<double> values) {
  return Response::from_dense(rows, image_rows * image_cols, std::move(values))
      .value()
      .with_image(image_rows, image_cols)
      .value();
}

Response pairs_of_pixels(double apart) {
  Random random(13);
  std::vector<double> values;
  for (int k = 0; k < 25 * 32; ++k) {
    const double value = random.uniform() < 0.5 ? random.uniform() : 0.0;
    values.push_back(value);
    values.push_back(value * (1.0 + apart * random.normal()));
  }
  return dense(25, 8, 8, std::move(values));
}

}  // namespace

Response ordinary_eye() {
  return seen_by(geometry(8.0));
}
Response narrow_eye() {
  return seen_by(geometry(1.5));
}
Response eye_of_10_deg() {
  return seen_by(geometry(10.0));
}
Response eye_of_60_deg() {
  return seen_by(geometry(60.0));
}
Response widest_eye() {
  return seen_by(geometry(120.0, 18.0));
}
Response azimuth_eye() {
  return seen_by(geometry(8.0, 2.5, Lattice::azimuth_elevation));
}
Response tangent_eye() {
  return seen_by(geometry(8.0, 2.5, Lattice::tangent));
}
Response plane_eye() {
  return seen_by(geometry(8.0, 2.5, Lattice::plane));
}
Response cylinder_eye() {
  return seen_by(geometry(8.0, 2.5, Lattice::cylinder));
}
Response flat_eye() {
  return seen_by(geometry(10.0, 0.01));
}
Response one_axis_eye() {
  return seen_by(geometry(10.0, 1e-9));
}

Response measured_rows() {
  return calib::plausible_response(geometry(8.0), plane_of(8, 8), {}, 5).value().with_image(8, 8).value();
}

Response eye_8x8() {
  hal::EyeGeometry eye = geometry(8.0, 1.5);
  eye.rows = eye.columns = 8;
  return seen_by(eye, 16, 16);
}

Response large_eye() {
  hal::EyeGeometry eye = geometry(15.0, 1.0);
  eye.rows = eye.columns = 80;
  return calib::nominal_response(eye, {160, 160, 80.0, 80.0, 30.0}).value().with_image(160, 160).value();
}

Response odd_picture() {
  return seen_by(geometry(8.0), 7, 9);
}
Response half_odd_picture() {
  return seen_by(geometry(8.0), 6, 10);
}
Response line_picture() {
  Random random(3);
  return random_response(random, 5, Picture{1, 12}, 0.7);
}
Response one_pixel() {
  return dense(3, 1, 1, {1.0, 0.5, 0.25});
}
Response one_of_each() {
  return dense(1, 1, 1, {0.75});
}
Response tall_rows() {
  Random random(11);
  return dense(600, 4, 6, random_vector(random, 600 * 24, 0.0, 1.0));
}
Response tall_eye() {
  Random random(12);
  const Response eye = seen_by(geometry(10.0), 4, 6);
  std::vector<double> values;
  for (int m = 0; m < 600; ++m) {
    std::vector<double> row(24, 0.0);
    eye.for_each_in_row(m % eye.rows(), [&](std::int32_t n, double v) {
      row[static_cast<std::size_t>(n)] = v * random.uniform(0.98, 1.02);
    });
    values.insert(values.end(), row.begin(), row.end());
  }
  return dense(600, 4, 6, std::move(values));
}
Response twin_pixels() {
  return pairs_of_pixels(1e-7);
}
Response near_twin_pixels() {
  return pairs_of_pixels(1e-4);
}
Response zero_response() {
  return dense(4, 2, 3, std::vector<double>(24, 0.0));
}
Response sees_last_pixel() {
  std::vector<double> values(6 * 64, 0.0);
  values.back() = 1.0;
  return dense(6, 8, 8, std::move(values));
}

}  // namespace compueye::tests
