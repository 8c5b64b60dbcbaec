#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace compueye::tests {

/// ||a - b|| / ||b||
inline double relative_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double difference = 0.0, size = 1e-30;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double d = static_cast<double>(a[k]) - static_cast<double>(b[k]);
    difference += d * d;
    size += static_cast<double>(b[k]) * static_cast<double>(b[k]);
  }
  return std::sqrt(difference / size);
}

}  // namespace compueye::tests
