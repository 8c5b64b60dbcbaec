#include "recon/conventional_image.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace compueye;
using namespace compueye::recon;

namespace {

// Ommatidia on a jittered grid, each seeing a small block of pixels with uneven weights; some rows blind.
Response narrow_eye(int grid, int image_side) {
  std::vector<std::int64_t> row_start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  const int step = image_side / grid;
  for (int i = 0; i < grid; ++i) {
    for (int k = 0; k < grid; ++k) {
      if ((i * 7 + k * 3) % 11 != 0) {
        for (int r = i * step; r < i * step + step; ++r) {
          for (int c = k * step; c < k * step + step; ++c) {
            columns.push_back(r * image_side + c);
            values.push_back(0.25 + ((i + 2 * k + r * 3 + c * 5) % 8) / 8.0);
          }
        }
      }
      row_start.push_back(static_cast<std::int64_t>(values.size()));
    }
  }
  return Response::from_csr(grid * grid, image_side * image_side, std::move(row_start), std::move(columns),
                            std::move(values))
      .value()
      .with_image(image_side, image_side)
      .value();
}

std::int32_t nearest_by_brute_force(const Response& a, int image_cols, int row, int col) {
  double best = std::numeric_limits<double>::infinity();
  std::int32_t best_m = -1;
  for (int m = 0; m < a.rows(); ++m) {
    double sum = 0.0, r = 0.0, c = 0.0;
    a.for_each_in_row(m, [&](std::int32_t n, double v) {
      sum += v;
      r += v * (n / image_cols);
      c += v * (n % image_cols);
    });
    if (sum <= 0.0) continue;
    const double d = (r / sum - row) * (r / sum - row) + (c / sum - col) * (c / sum - col);
    if (d < best) {
      best = d;
      best_m = m;
    }
  }
  return best_m;
}

}  // namespace

TEST_CASE("every pixel shows the nearest seeing ommatidium") {
  for (const auto& [ommatidia, side] : {std::pair{1, 4}, {5, 20}, {8, 16}, {12, 36}}) {
    const int grid = ommatidia;
    CAPTURE(grid);
    Response eye = narrow_eye(grid, side);
    if (grid == 1) {
      eye = Response::from_dense(1, 16, std::vector<double>(16, 0.5)).value().with_image(4, 4).value();
    }
    const auto image = ConventionalImage::create(eye).value();
    REQUIRE(image.source_rows().size() == static_cast<std::size_t>(side * side));
    int wrong = 0;
    for (int r = 0; r < side; ++r) {
      for (int c = 0; c < side; ++c) {
        const auto m = image.source_rows()[static_cast<std::size_t>(r * side + c)];
        wrong += m != nearest_by_brute_force(eye, side, r, c) ? 1 : 0;
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("a white scene is shown white and a brighter or darker one is clipped") {
  const Response eye = narrow_eye(8, 16);
  const auto image = ConventionalImage::create(eye).value();
  std::vector<double> y_exact(64);
  eye.forward(std::vector<double>(256, 1.0), y_exact);
  std::vector<float> y(y_exact.begin(), y_exact.end()), picture(256);
  image.render(y, picture);
  for (const float v : picture) CHECK(v == doctest::Approx(1.0).epsilon(1e-6));
  for (float& v : y) v *= 0.5F;
  image.render(y, picture);
  for (const float v : picture) CHECK(v == doctest::Approx(0.5).epsilon(1e-6));
  for (float& v : y) v *= 3.0F;
  image.render(y, picture);
  CHECK(*std::max_element(picture.begin(), picture.end()) == 1.0F);
  for (float& v : y) v = -v;
  image.render(y, picture);
  CHECK(*std::max_element(picture.begin(), picture.end()) == 0.0F);
}

TEST_CASE("a sample that is NaN shows black where its ommatidium looks") {
  const auto eye = Response::from_dense(2, 4, {1, 1, 0, 0, 0, 0, 1, 1}).value().with_image(1, 4).value();
  const auto image = ConventionalImage::create(eye).value();
  std::vector<float> picture(4, -1.0F);
  image.render(std::vector<float>{std::numeric_limits<float>::quiet_NaN(), 1.0F}, picture);
  CHECK(picture == std::vector<float>{0.0F, 0.0F, 0.5F, 0.5F});
  image.render(std::vector<float>{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()},
               picture);
  CHECK(picture == std::vector<float>{1.0F, 1.0F, 0.0F, 0.0F});
}

TEST_CASE("equally near ommatidia: the first one is shown") {
  const auto eye = Response::from_dense(3, 3, {0, 0, 0, 1, 0, 0, 0, 0, 1}).value().with_image(1, 3).value();
  const auto image = ConventionalImage::create(eye).value();
  CHECK(std::vector<std::int32_t>(image.source_rows().begin(), image.source_rows().end()) ==
        std::vector<std::int32_t>{1, 1, 2});
  const auto twins = Response::from_dense(2, 2, {1, 1, 1, 1}).value().with_image(2, 1).value();
  const auto both = ConventionalImage::create(twins).value();
  CHECK(both.source_rows()[0] == 0);
  CHECK(both.source_rows()[1] == 0);
}

TEST_CASE("a conventional eye that cannot be one is refused") {
  const auto eye = Response::from_dense(1, 6, std::vector<double>(6, 1.0)).value();
  CHECK(eye.with_image(2, 2).error().code == hal::ErrorCode::mismatch);
  CHECK(eye.with_image(0, 6).error().code == hal::ErrorCode::mismatch);
  CHECK(eye.with_image(-2, -3).error().code == hal::ErrorCode::mismatch);
  const auto blind = Response::from_dense(2, 2, {0, 0, -1, 0.5}).value().with_image(1, 2).value();
  CHECK(ConventionalImage::create(blind).error().code == hal::ErrorCode::out_of_range);
}
