#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/pictures/pictures.hpp"
#include "sim/pictures/strokes.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim::pictures {
namespace {

constexpr double ink = 0.23;  // share of non-zero pixels

// A gentle bend of the whole sheet, so that every seed is another drawing and every drawing still hangs together.
void bend(Strokes& strokes, std::uint64_t seed) {
  RandomStream random({seed, Draws::picture, 0, 1});
  const bool mirrored = random.below(2) == 1;
  const double scale = random.uniform(0.9, 0.98);
  const double turn = random.uniform(-0.06, 0.06);  // tan of half the angle
  const double cosine = (1.0 - turn * turn) / (1.0 + turn * turn);
  const double sine = 2.0 * turn / (1.0 + turn * turn);
  std::array<double, 6> warp{};
  for (double& w : warp) w = random.uniform(-0.12, 0.12);
  const auto move = [&](Point& p) {
    double x = p.x - 0.5, y = p.y - 0.5;
    if (mirrored) x = -x;
    const double wx = x + warp[0] * x * y + warp[1] * (y * y - 0.1) + warp[2] * (x * x - 0.1);
    const double wy = y + warp[3] * x * y + warp[4] * (x * x - 0.1) + warp[5] * (y * y - 0.1);
    p = {0.5 + scale * (cosine * wx - sine * wy), 0.5 + scale * (sine * wx + cosine * wy)};
  };
  for (Strokes::Segment& segment : strokes.segments()) {
    move(segment.a);
    move(segment.b);
  }
}

Strokes drawing(std::uint64_t seed) {
  if (seed == 0) return draw_butterfly();
  constexpr std::array drawings{draw_house, draw_fish, draw_sailing_boat, draw_butterfly};
  Strokes strokes = drawings[static_cast<std::size_t>((seed - 1) % drawings.size())]();
  bend(strokes, seed);
  return strokes;
}

}  // namespace

hal::Image line_art(int rows, int cols, std::uint64_t seed) {
  const double side = std::min(rows, cols);
  hal::Image picture = distance_field(drawing(seed), rows, cols, std::max(0.04 * side, 2.0));
  // The pen is as wide as the wanted share of ink asks for: the distance that this share of the pixels falls below.
  std::vector<float> sorted = picture.pixels;
  const auto inked = sorted.begin() + static_cast<std::ptrdiff_t>(ink * side * side);
  std::nth_element(sorted.begin(), inked, sorted.end());
  const float edge = std::isfinite(*inked) ? *inked : static_cast<float>(std::max(0.04 * side, 2.0));
  const float ramp = std::clamp(edge, 1e-6F, 1.0F);  // one pixel of grey at the rim, as from a scanned drawing
  for (float& pixel : picture.pixels) pixel = std::clamp((edge - pixel) / ramp, 0.0F, 1.0F);
  return picture;
}

}  // namespace compueye::sim::pictures
