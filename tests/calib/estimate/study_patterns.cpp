#include "tests/calib/estimate/study_patterns.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "sim/random/random.hpp"

namespace compueye::test {
namespace {

/// Of a display of 16 pixels a side and less, and of larger ones.
constexpr std::array small_sizes_px{0.0, 0.7, 1.2, 2.0, 3.2}, large_sizes_px{1.0, 2.0, 3.0, 5.0, 8.0};

std::vector<double> kernel(double size_px) {
  const int reach = static_cast<int>(std::ceil(3.0 * size_px));
  std::vector<double> weights;
  for (int i = -reach; i <= reach; ++i)
    weights.push_back(size_px > 0.0 ? std::exp(-0.5 * i * i / (size_px * size_px)) : 1.0);
  return weights;
}

/// One value a pixel, from one a pixel of a larger field.
std::vector<double> smoothed(const std::vector<double>& noise, int rows, int cols, const std::vector<double>& weights) {
  const auto reach = static_cast<int>(weights.size()) - 1, wide = cols + reach;
  std::vector<double> along, all;
  for (int r = 0; r < rows + reach; ++r) {
    for (int c = 0; c < cols; ++c) {
      double sum = 0.0;
      for (int i = 0; i <= reach; ++i)
        sum += weights[static_cast<std::size_t>(i)] * noise[static_cast<std::size_t>(r * wide + c + i)];
      along.push_back(sum);
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      double sum = 0.0;
      for (int i = 0; i <= reach; ++i)
        sum += weights[static_cast<std::size_t>(i)] * along[static_cast<std::size_t>((r + i) * cols + c)];
      all.push_back(sum);
    }
  }
  return all;
}

}  // namespace

std::vector<float> blob_patterns(int rows, int cols, int count, std::uint64_t seed) {
  const auto& sizes = std::max(rows, cols) > 16 ? large_sizes_px : small_sizes_px;
  std::vector<float> patterns;
  for (int p = 0; p < count; ++p) {
    sim::RandomStream random({seed, sim::Draws::picture, static_cast<std::uint64_t>(p), 5});
    const std::vector<double> weights = kernel(sizes[static_cast<std::size_t>(p) % sizes.size()]);
    const auto reach = static_cast<int>(weights.size()) - 1;
    std::vector<double> noise;
    for (int n = 0; n < (rows + reach) * (cols + reach); ++n) noise.push_back(random.gaussian());
    for (const double value : smoothed(noise, rows, cols, weights)) patterns.push_back(value > 0.0 ? 1.0F : 0.0F);
  }
  return patterns;
}

std::vector<float> sylvester_patterns(int pixels) {
  std::vector<float> patterns;
  for (unsigned p = 0; p < static_cast<unsigned>(pixels); ++p) {
    for (unsigned n = 0; n < static_cast<unsigned>(pixels); ++n) {
      patterns.push_back(p == 0 || std::popcount(p & n) % 2 == 1 ? 1.0F : 0.0F);
    }
  }
  return patterns;
}

std::vector<float> raster_patterns(int pixels) {
  const auto width = static_cast<std::size_t>(pixels);
  std::vector<float> patterns(width * width, 0.0F);
  for (std::size_t n = 0; n < width; ++n) patterns[n * width + n] = 1.0F;
  return patterns;
}

}  // namespace compueye::test
