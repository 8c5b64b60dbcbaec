#pragma once

#include <cstddef>
#include <vector>

#include "bench/timing.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::bench {

/// GB/s at which one core reads 256 MiB that no cache holds.
inline double read_bandwidth() {
  const std::vector<float> memory(std::size_t{64} << 20U, 1.0F);
  volatile float sum = 0.0F;
  const double ms = median_ms([&] { sum = recon::core::sum_of_magnitudes(memory.data(), memory.size()); }, 9);
  return static_cast<double>(memory.size() * sizeof(float)) / ms * 1e-6;
}

}  // namespace compueye::bench
