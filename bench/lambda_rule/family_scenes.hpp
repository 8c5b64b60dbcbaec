#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/image.hpp"

namespace compueye::bench {

/// "texture" (random phases, amplitudes 1/f), "half-plane" (a straight edge of random place and contrast) and the
/// built-in scenes that stand for drawings, dots and blocks.
[[nodiscard]] std::vector<std::string> family_scenes();

/// One of them, intensities 0..1. The same name, size and seed give the same picture.
[[nodiscard]] hal::Image family_picture(const std::string& name, int rows, int cols, std::uint64_t seed);

}  // namespace compueye::bench
