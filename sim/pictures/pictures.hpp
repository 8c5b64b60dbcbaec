#pragma once

#include <cstdint>

#include "hal/image.hpp"
#include "hal/result.hpp"

// The generators behind sim/pictures/built_in_scenes.hpp. Each takes rows and cols of at least 1 and gives linear
// intensities 0..1; the same seed gives the same bits on every platform, so they use basic arithmetic and square roots
// only.
namespace compueye::sim::pictures {

[[nodiscard]] hal::Image line_art(int rows, int cols, std::uint64_t seed);
[[nodiscard]] hal::Image phantom(int rows, int cols, std::uint64_t seed);
[[nodiscard]] hal::Image bars(int rows, int cols, std::uint64_t seed);
[[nodiscard]] hal::Image dots(int rows, int cols, std::uint64_t seed);
[[nodiscard]] hal::Image text(int rows, int cols, std::uint64_t seed);
[[nodiscard]] hal::Image siemens_star(int rows, int cols);
[[nodiscard]] hal::Image slanted_edge(int rows, int cols, std::uint64_t seed);
/// Error out_of_range below 16x16.
[[nodiscard]] hal::Result<hal::Image> fig2(int rows, int cols);

}  // namespace compueye::sim::pictures
