#include "sim/scene/surface.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace compueye;

namespace {

sim::Surface card(const std::vector<std::vector<float>>& bands) {
  sim::Surface surface;
  for (const std::vector<float>& pixels : bands) {
    surface.bands.emplace_back(1, static_cast<int>(pixels.size()));
    surface.bands.back().pixels = pixels;
  }
  return surface;
}

}  // namespace

TEST_CASE("bands count by their weights, and grey is their mean") {
  const sim::Surface coloured = card({{0.5F, 8.0F}, {0.25F, 0.0F}, {1.0F, 4.0F}});
  CHECK(coloured.weighed({0.5, 0.25, 2.0}).pixels == std::vector<float>{2.3125F, 12.0F});
  CHECK(coloured.weighed({0.0, 0.0, -1.0}).pixels == std::vector<float>{-1.0F, -4.0F});
  const std::vector<float> grey = coloured.grey().pixels;
  CHECK(grey[0] == doctest::Approx(1.75 / 3.0).epsilon(1e-7));
  CHECK(grey[1] == doctest::Approx(4.0).epsilon(1e-7));
}

TEST_CASE("one band counts as all three, and is grey to the bit") {
  const std::vector<float> pixels{0.1F, 0.7F, 1e-30F};
  const sim::Surface plain = card({pixels});
  CHECK(plain.grey().pixels == pixels);
  CHECK(plain.weighed({0.5, 0.25, 1.25}).pixels[1] == doctest::Approx(1.4).epsilon(1e-6));
}
