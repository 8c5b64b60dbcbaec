#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "recon/problem/response.hpp"

namespace compueye::tests {

/// mt19937_64's integers are the same on every platform; the library's distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lo = 0.0, double hi = 1.0) {
    return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double normal() {
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum - 6.0;
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }

 private:
  std::mt19937_64 engine_;
};

inline recon::Response random_response(Random& random, int rows, int cols, double density) {
  std::vector<std::int64_t> start{0};
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  for (int m = 0; m < rows; ++m) {
    for (int n = 0; n < cols; ++n) {
      if (random.uniform() >= density) continue;
      columns.push_back(n);
      values.push_back(random.uniform(-0.2, 1.0));
    }
    start.push_back(static_cast<std::int64_t>(values.size()));
  }
  return recon::Response::from_csr(rows, cols, start, columns, values).value();
}

/// The pixels that a response's columns are.
struct Picture {
  int rows, cols;
};

inline recon::Response random_response(Random& random, int rows, const Picture& picture, double density) {
  return random_response(random, rows, picture.rows * picture.cols, density)
      .with_image(picture.rows, picture.cols)
      .value();
}

inline std::vector<double> random_vector(Random& random, int n, double lo = -1.0, double hi = 1.0) {
  std::vector<double> v(static_cast<std::size_t>(n));
  for (double& value : v) value = random.uniform(lo, hi);
  return v;
}

inline std::vector<float> to_float(const std::vector<double>& v) {
  return {v.begin(), v.end()};
}

}  // namespace compueye::tests
