#include "recon/metrics.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::recon;
using hal::ErrorCode;
using hal::Image;

namespace {

Image pattern(int rows, int cols, int a, int b, int k, int m) {
  Image image(rows, cols);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      image.at(r, c) = static_cast<float>((r * a + c * b + r * c * k) % m) / static_cast<float>(m - 1);
    }
  }
  return image;
}

Image texture(int rows, int cols) {
  return pattern(rows, cols, 37, 61, 7, 97);
}
Image ramp(int rows, int cols) {
  return pattern(rows, cols, 1, 2, 0, 101);
}

template <class Combine>
Image combine(const Image& p, const Image& q, Combine&& f) {
  Image out = p;
  for (std::size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = f(p.pixels[i], q.pixels[i]);
  return out;
}

// Straight from the paper's equations: at each position the 2-D window's own weighted mean, variance and covariance,
// as sums of deviations and not as differences of moments.
double direct_ssim(const Image& x, const Image& t) {
  const int height = std::min(x.rows, 11), width = std::min(x.cols, 11);
  std::vector<long double> w;
  long double total = 0;
  for (int i = 0; i < height; ++i) {
    for (int j = 0; j < width; ++j) {
      const long double di = i - (height - 1) / 2.0L, dj = j - (width - 1) / 2.0L;
      w.push_back(std::exp(-(di * di + dj * dj) / (2.0L * 1.5L * 1.5L)));
      total += w.back();
    }
  }
  long double sum = 0;
  long positions = 0;
  for (int r = 0; r + height <= x.rows; ++r) {
    for (int c = 0; c + width <= x.cols; ++c, ++positions) {
      const auto average = [&](auto&& f) {
        long double s = 0;
        for (int i = 0; i < height; ++i) {
          for (int j = 0; j < width; ++j) {
            s += w[static_cast<std::size_t>(i * width + j)] *
                 f(static_cast<long double>(x.at(r + i, c + j)), static_cast<long double>(t.at(r + i, c + j)));
          }
        }
        return s / total;
      };
      const long double mx = average([](auto a, auto) { return a; });
      const long double mt = average([](auto, auto b) { return b; });
      const long double vx = average([&](auto a, auto) { return (a - mx) * (a - mx); });
      const long double vt = average([&](auto, auto b) { return (b - mt) * (b - mt); });
      const long double cov = average([&](auto a, auto b) { return (a - mx) * (b - mt); });
      sum += (2 * mx * mt + 1e-4L) * (2 * cov + 9e-4L) / ((mx * mx + mt * mt + 1e-4L) * (vx + vt + 9e-4L));
    }
  }
  return static_cast<double>(sum / positions);
}

}  // namespace

TEST_CASE("NMSE and PSNR are what their formulas say") {
  Image truth(2, 2);
  truth.pixels = {1.0F, 0.5F, 0.0F, 0.5F};
  Image picture = truth;
  picture.pixels[2] = 0.5F;
  CHECK(nmse(picture, truth).value() == doctest::Approx(0.25 / 1.5).epsilon(1e-14));
  CHECK(psnr(picture, truth).value() == doctest::Approx(10.0 * std::log10(1.0 / 0.0625)).epsilon(1e-14));
  CHECK(psnr(picture, truth, 2.0).value() == doctest::Approx(10.0 * std::log10(4.0 / 0.0625)).epsilon(1e-14));
  CHECK(nmse(truth, truth).value() == 0.0);
  CHECK(psnr(truth, truth).value() == std::numeric_limits<double>::infinity());
  CHECK(nmse(Image(2, 2), truth).value() == doctest::Approx(1.0));
}

TEST_CASE("an all-black truth has a defined NMSE") {
  CHECK(nmse(Image(3, 3), Image(3, 3)).value() == 0.0);
  CHECK(nmse(Image(3, 3, 0.1F), Image(3, 3)).value() == std::numeric_limits<double>::infinity());
  CHECK(ssim(Image(3, 3), Image(3, 3)).value() == doctest::Approx(1.0));
}

TEST_CASE("SSIM agrees with SciPy") {
  // Made once with SciPy 1.10: g = gaussian_filter(., sigma=1.5, truncate=3.5)[5:-5, 5:-5], an 11 x 11 window;
  // mean of (2 mx mt + c1)(2 (g(xt) - mx mt) + c2) / ((mx^2 + mt^2 + c1)(vx + vt + c2)), c1 = .01^2, c2 = .03^2.
  struct Golden {
    int rows, cols;
    double ramp, mix, negative;
  };
  for (const Golden& g : {Golden{11, 11, 0.023288058337, 0.692029222993, -0.971023189005},
                          Golden{16, 16, -0.000761031265, 0.705510924618, -0.912670599209},
                          Golden{40, 23, 0.008894099917, 0.753401659384, -0.961088461932}}) {
    CAPTURE(g.rows);
    const Image truth = texture(g.rows, g.cols), smooth = ramp(g.rows, g.cols);
    const Image mix = combine(truth, smooth, [](float t, float s) { return 0.5F * t + 0.25F * s; });
    const Image negative = combine(truth, truth, [](float t, float) { return 1.0F - t; });
    CHECK(std::abs(ssim(smooth, truth).value() - g.ramp) < 1e-6);
    CHECK(std::abs(ssim(mix, truth).value() - g.mix) < 1e-6);
    CHECK(std::abs(ssim(negative, truth).value() - g.negative) < 1e-6);
  }
}

TEST_CASE("SSIM agrees with direct sums over every window, small pictures included") {
  for (const auto& [height, width] : {std::pair{32, 32}, {11, 40}, {10, 10}, {16, 5}, {1, 1}, {1, 30}, {12, 11}}) {
    const int rows = height, cols = width;  // clang 14 captures no structured binding
    CAPTURE(rows);
    CAPTURE(cols);
    const Image truth = texture(rows, cols);
    const Image picture = combine(truth, ramp(rows, cols), [](float t, float s) { return t * s - 0.1F; });
    CHECK(std::abs(ssim(picture, truth).value() - direct_ssim(picture, truth)) < 1e-9);
    CHECK(ssim(truth, truth).value() == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(ssim(picture, truth).value() == doctest::Approx(ssim(truth, picture).value()).epsilon(1e-12));
  }
}

TEST_CASE("metrics refuse what has no answer and say why") {
  const Image truth = texture(12, 13);
  Image spoiled = truth;
  spoiled.at(3, 7) = std::numeric_limits<float>::quiet_NaN();
  for (const auto& metric : {+[](const PictureView&x, const PictureView&t) { return nmse(x, t); },
                             +[](const PictureView&x, const PictureView&t) { return psnr(x, t); },
                             +[](const PictureView&x, const PictureView&t) { return ssim(x, t); }}) {
    test::check_error(metric(texture(13, 12), truth), ErrorCode::mismatch, "picture", {"12", "13"});
    test::check_error(metric(texture(11, 14), truth), ErrorCode::mismatch, "picture", {"11", "14", "12", "13"});
    test::check_error(metric(spoiled, truth), ErrorCode::out_of_range, "picture", {"nan", "3", "7"});
    test::check_error(metric(truth, spoiled), ErrorCode::out_of_range, "truth", {"nan", "3", "7"});
    CHECK_FALSE(metric(Image(), Image()).has_value());
    CHECK_FALSE(metric(PictureView(truth.pixels, 12, 12), PictureView(truth.pixels, 12, 12)).has_value());
  }
  spoiled.at(3, 7) = std::numeric_limits<float>::infinity();
  CHECK_FALSE(ssim(spoiled, truth).has_value());
  CHECK(psnr(truth, truth, 0.0).error().code == ErrorCode::usage);
  CHECK(psnr(truth, truth, std::nan("")).error().code == ErrorCode::usage);
}

TEST_CASE("Michelson contrast compares the means of the bars") {
  Image bars(2, 4);
  bars.pixels = {0.8F, 0.2F, 0.6F, 0.0F, 0.8F, 0.2F, 0.6F, 0.0F};
  const std::vector<std::int32_t> bright{0, 2, 4, 6}, dark{1, 3, 5, 7};
  CHECK(michelson_contrast(bars, bright, dark).value() == doctest::Approx((0.7 - 0.1) / (0.7 + 0.1)).epsilon(1e-6));
  CHECK(michelson_contrast(bars, dark, bright).value() == doctest::Approx(-0.75).epsilon(1e-6));
  CHECK(michelson_contrast(Image(2, 4, 0.3F), bright, dark).value() == 0.0);
  CHECK(michelson_contrast(Image(2, 4), bright, dark).value() == 0.0);

  CHECK(michelson_contrast(bars, {}, dark).error().code == ErrorCode::usage);
  CHECK(michelson_contrast(bars, bright, {}).error().code == ErrorCode::usage);
  const std::vector<std::int32_t> beyond{8}, negative{-1};
  CHECK(michelson_contrast(bars, beyond, dark).error().code == ErrorCode::out_of_range);
  CHECK(michelson_contrast(bars, bright, negative).error().code == ErrorCode::out_of_range);
  Image cancelling(1, 2);
  cancelling.pixels = {0.5F, -0.5F};
  const std::vector<std::int32_t> first{0}, second{1};
  CHECK(michelson_contrast(cancelling, first, second).error().code == ErrorCode::out_of_range);
  cancelling.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(michelson_contrast(cancelling, first, second).has_value());
}
