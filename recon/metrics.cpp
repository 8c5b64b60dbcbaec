#include "recon/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

std::string size_text(const PictureView& p) {
  return std::to_string(p.rows) + " x " + std::to_string(p.cols);
}

Result<void> check(const char* place, const PictureView& p) {
  if (p.rows < 1 || p.cols < 1) {
    return fail(ErrorCode::out_of_range, place, "is " + size_text(p) + " pixels, expected at least 1 x 1");
  }
  if (p.pixels.size() != static_cast<std::size_t>(p.rows) * static_cast<std::size_t>(p.cols)) {
    return fail(ErrorCode::mismatch, place,
                "has " + std::to_string(p.pixels.size()) + " pixels, expected " + size_text(p));
  }
  const auto bad = std::find_if(p.pixels.begin(), p.pixels.end(), [](float v) { return !std::isfinite(v); });
  if (bad != p.pixels.end()) {
    const auto at = bad - p.pixels.begin();
    return fail(ErrorCode::out_of_range, place,
                "is " + std::to_string(*bad) + " at row " + std::to_string(at / p.cols) + ", column " +
                    std::to_string(at % p.cols) + " (from 0), expected a finite intensity");
  }
  return {};
}

Result<void> check_pair(const PictureView& picture, const PictureView& truth) {
  if (picture.rows != truth.rows || picture.cols != truth.cols) {
    return fail(ErrorCode::mismatch, "picture",
                "is " + size_text(picture) + " pixels, expected the size of the truth, " + size_text(truth));
  }
  return check("picture", picture).and_then([&] { return check("truth", truth); });
}

struct Energies {
  double error = 0.0;
  double truth = 0.0;
};

Energies energies(const PictureView& picture, const PictureView& truth) {
  Energies sum;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    const double t = truth.pixels[i];
    const double d = picture.pixels[i] - t;
    sum.error += d * d;
    sum.truth += t * t;
  }
  return sum;
}

constexpr int ssim_window = 11;
constexpr double ssim_sigma = 1.5;

std::vector<double> gaussian_window(int length) {
  std::vector<double> w(static_cast<std::size_t>(length));
  double sum = 0.0;
  for (int k = 0; k < length; ++k) {
    const double distance = k - (length - 1) / 2.0;
    sum += w[static_cast<std::size_t>(k)] = std::exp(-distance * distance / (2.0 * ssim_sigma * ssim_sigma));
  }
  for (double& v : w) v /= sum;
  return w;
}

// The window is separable: first along the rows, then down the columns, "valid" positions only.
template <class Pixel>
std::vector<double> local_mean(Pixel&& pixel, int rows, int cols, const std::vector<double>& down,
                               const std::vector<double>& across) {
  const int out_rows = rows - static_cast<int>(down.size()) + 1;
  const int out_cols = cols - static_cast<int>(across.size()) + 1;
  const auto width = static_cast<std::size_t>(out_cols);
  std::vector<double> along(static_cast<std::size_t>(rows) * width);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < out_cols; ++c) {
      double sum = 0.0;
      for (std::size_t k = 0; k < across.size(); ++k) sum += across[k] * pixel(r, c + static_cast<int>(k));
      along[static_cast<std::size_t>(r) * width + static_cast<std::size_t>(c)] = sum;
    }
  }
  std::vector<double> mean(static_cast<std::size_t>(out_rows) * width, 0.0);
  for (std::size_t i = 0; i < mean.size(); ++i) {
    for (std::size_t k = 0; k < down.size(); ++k) mean[i] += down[k] * along[i + k * width];
  }
  return mean;
}

double similarity(double mean_x, double mean_t, double xx, double tt, double xt) {
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  const double var_x = xx - mean_x * mean_x;
  const double var_t = tt - mean_t * mean_t;
  const double cov = xt - mean_x * mean_t;
  return (2.0 * mean_x * mean_t + c1) * (2.0 * cov + c2) /
         ((mean_x * mean_x + mean_t * mean_t + c1) * (var_x + var_t + c2));
}

Result<double> mean_at(const PictureView& picture, std::span<const std::int32_t> indices, const char* place) {
  if (indices.empty()) return fail(ErrorCode::usage, place, "have no pixels, expected at least one");
  double sum = 0.0;
  for (const std::int32_t i : indices) {
    if (i < 0 || static_cast<std::size_t>(i) >= picture.pixels.size()) {
      return fail(
          ErrorCode::out_of_range, place,
          "have the pixel index " + std::to_string(i) + ", expected 0 to " + std::to_string(picture.pixels.size() - 1));
    }
    sum += picture.pixels[static_cast<std::size_t>(i)];
  }
  return sum / static_cast<double>(indices.size());
}

}  // namespace

Result<double> nmse(const PictureView& picture, const PictureView& truth) {
  if (auto ok = check_pair(picture, truth); !ok) return tl::unexpected(ok.error());
  const Energies e = energies(picture, truth);
  if (e.truth == 0.0) return e.error == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  return e.error / e.truth;
}

Result<double> psnr(const PictureView& picture, const PictureView& truth, double peak) {
  if (!(peak > 0.0) || !std::isfinite(peak)) {
    return fail(ErrorCode::usage, "peak", "is " + std::to_string(peak) + ", expected a positive finite intensity");
  }
  if (auto ok = check_pair(picture, truth); !ok) return tl::unexpected(ok.error());
  const double mse = energies(picture, truth).error / static_cast<double>(truth.pixels.size());
  if (mse == 0.0) return std::numeric_limits<double>::infinity();
  return 10.0 * std::log10(peak * peak / mse);
}

Result<double> ssim(const PictureView& picture, const PictureView& truth) {
  if (auto ok = check_pair(picture, truth); !ok) return tl::unexpected(ok.error());
  const int rows = truth.rows, cols = truth.cols;
  const std::vector<double> down = gaussian_window(std::min(rows, ssim_window));
  const std::vector<double> across = gaussian_window(std::min(cols, ssim_window));
  const auto at = [cols](const PictureView& p, int r, int c) {
    return static_cast<double>(
        p.pixels[static_cast<std::size_t>(r) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(c)]);
  };
  const auto mean = [&](auto&& pixel) { return local_mean(pixel, rows, cols, down, across); };
  const auto x = mean([&](int r, int c) { return at(picture, r, c); });
  const auto t = mean([&](int r, int c) { return at(truth, r, c); });
  const auto xx = mean([&](int r, int c) { return at(picture, r, c) * at(picture, r, c); });
  const auto tt = mean([&](int r, int c) { return at(truth, r, c) * at(truth, r, c); });
  const auto xt = mean([&](int r, int c) { return at(picture, r, c) * at(truth, r, c); });
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += similarity(x[i], t[i], xx[i], tt[i], xt[i]);
  return sum / static_cast<double>(x.size());
}

Result<double> michelson_contrast(const PictureView& picture, std::span<const std::int32_t> bright,
                                  std::span<const std::int32_t> dark) {
  if (auto ok = check("picture", picture); !ok) return tl::unexpected(ok.error());
  auto high = mean_at(picture, bright, "bright bars");
  if (!high) return high;
  auto low = mean_at(picture, dark, "dark bars");
  if (!low) return low;
  const double sum = *high + *low;
  if (*high == 0.0 && *low == 0.0) return 0.0;
  if (sum == 0.0) {
    return fail(ErrorCode::out_of_range, "picture",
                "has bars of mean " + std::to_string(*high) + " and " + std::to_string(*low) +
                    ", which cancel; expected intensities of 0 or more");
  }
  return (*high - *low) / sum;
}

}  // namespace compueye::recon
