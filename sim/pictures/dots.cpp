#include <algorithm>

#include "sim/pictures/pictures.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim::pictures {

hal::Image dots(int rows, int cols, std::uint64_t seed) {
  hal::Image picture(rows, cols);
  const auto pixels = static_cast<std::uint32_t>(picture.pixels.size());
  const std::uint32_t wanted = std::max(pixels / 100, 1U);
  // One stream a dot, as a stream is shorter than the dots of a large picture.
  for (std::uint32_t dot = 0; dot < wanted; ++dot) {
    RandomStream random({seed, Draws::picture, 1 + std::uint64_t{dot}, 4});
    float* pixel = &picture.pixels[random.below(pixels)];
    while (*pixel != 0.0F) pixel = &picture.pixels[random.below(pixels)];
    *pixel = static_cast<float>(random.uniform(0.5, 1.0));
  }
  return picture;
}

}  // namespace compueye::sim::pictures
