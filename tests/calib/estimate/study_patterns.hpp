#pragma once

#include <cstdint>
#include <vector>

namespace compueye::test {

/// Patterns as rows of P x (rows cols) values 0 or 1, for trying the estimator before a session's own families exist.

/// Half of the display white, in blobs of five sizes in turn: noise smoothed by Gaussians of `sizes_px` and cut at 0.
[[nodiscard]] std::vector<float> blob_patterns(int rows, int cols, int count, std::uint64_t seed);

/// Sylvester's Hadamard matrix of order `pixels` (a power of two) as zeros and ones, its empty row as all ones.
[[nodiscard]] std::vector<float> sylvester_patterns(int pixels);

/// One pixel after the other.
[[nodiscard]] std::vector<float> raster_patterns(int pixels);

}  // namespace compueye::test
