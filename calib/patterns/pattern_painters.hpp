#pragma once

#include <cstdint>

#include "hal/image.hpp"

/// How each family of pattern_family.hpp is drawn, and how many patterns it has.
namespace compueye::calib {

/// One lit pixel.
[[nodiscard]] std::int64_t raster_count(int rows, int cols);
[[nodiscard]] hal::Image raster_pattern(int rows, int cols, std::uint64_t seed, std::int64_t index);

/// A lit disc, an eighth of the shorter side across, moved by half of that.
[[nodiscard]] std::int64_t spot_count(int rows, int cols);
[[nodiscard]] hal::Image spot_pattern(int rows, int cols, std::uint64_t seed, std::int64_t index);

/// Rows of an S-matrix (Harwit & Sloane 1979, "Hadamard transform optics"): of a normalised Hadamard matrix, 1 where
/// it has -1. Of order N = rows * cols where there is one, as the Kronecker product of one for the rows and one for the
/// columns where there are both (so that a pattern is separable): then pattern 0 is all on, for the one pixel that no
/// other pattern lights. Otherwise of the next order n above N, without its first row, cropped to N of its columns
/// after the first; it has n - 1 patterns.
[[nodiscard]] std::int64_t hadamard_count(int rows, int cols);
[[nodiscard]] hal::Image hadamard_pattern(int rows, int cols, std::uint64_t seed, std::int64_t index);

/// 0.5 +- 0.5 times a product of two cosines of DCT-II, long waves first; + at even indices, - at odd ones.
[[nodiscard]] std::int64_t dct_count(int rows, int cols);
[[nodiscard]] hal::Image dct_pattern(int rows, int cols, std::uint64_t seed, std::int64_t index);

/// Half of the pixels lit: those where a sum of random lattices is largest, each interpolated, all of one variance,
/// with knots 1, 2, 4 ... pixels apart up to half the longer side (4096 at most). So light and dark patches of every
/// size are as frequent.
[[nodiscard]] hal::Image blob_pattern(int rows, int cols, std::uint64_t seed, std::int64_t index);

}  // namespace compueye::calib
