#include <algorithm>
#include <utility>
#include <vector>

#include "calib/patterns/pattern_painters.hpp"

namespace compueye::calib {
namespace {

// Taylor's series up to pi / 4, whose rest is below half a unit of the last place; products and sums only, so that
// every platform rounds alike, which no library's cosine does.
double small_cosine(double x) noexcept {
  const double z = x * x;
  double sum = 1.0;
  for (int n = 16; n >= 2; n -= 2) sum = 1.0 - z * sum / (n * (n - 1));
  return sum;
}
double small_sine(double x) noexcept {
  const double z = x * x;
  double sum = 1.0;
  for (int n = 17; n >= 3; n -= 2) sum = 1.0 - z * sum / (n * (n - 1));
  return x * sum;
}

/// cos(pi k / n), k >= 0.
double cosine(std::int64_t k, std::int64_t n) noexcept {
  constexpr double pi = 3.14159265358979323846;
  k %= 2 * n;
  if (k > n) k = 2 * n - k;
  if (2 * k > n) return -cosine(n - k, n);
  const auto whole = static_cast<double>(n);
  if (4 * k <= n) return small_cosine(pi * static_cast<double>(k) / whole);
  return small_sine(pi * static_cast<double>(n - 2 * k) / (2.0 * whole));
}

/// cos(pi (2 i + 1) frequency / (2 n)) for i = 0 .. n-1.
std::vector<double> wave(int frequency, int n) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) values.push_back(cosine((2 * std::int64_t{i} + 1) * frequency, 2 * std::int64_t{n}));
  return values;
}

/// The frequencies down and across at a place of the order by their sum.
std::pair<int, int> frequencies_at(int rows, int cols, std::int64_t place) {
  for (int sum = 0;; ++sum) {
    const int least_down = std::max(0, sum - cols + 1), most_down = std::min(sum, rows - 1);
    const int here = most_down - least_down + 1;
    if (place < here) {
      const int down = least_down + static_cast<int>(place);
      return {down, sum - down};
    }
    place -= here;
  }
}

}  // namespace

std::int64_t dct_count(int rows, int cols) {
  return 2 * std::int64_t{rows} * cols;
}

hal::Image dct_pattern(int rows, int cols, std::uint64_t, std::int64_t index) {
  const auto frequencies = frequencies_at(rows, cols, index / 2);
  const std::vector<double> down = wave(frequencies.first, rows), across = wave(frequencies.second, cols);
  const double half = index % 2 == 0 ? 0.5 : -0.5;
  hal::Image image(rows, cols);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const double product = down[static_cast<std::size_t>(r)] * across[static_cast<std::size_t>(c)];
      image.at(r, c) = static_cast<float>(0.5 + half * product);
    }
  }
  return image;
}

}  // namespace compueye::calib
