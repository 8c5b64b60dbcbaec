#include <algorithm>
#include <array>
#include <utility>

#include "sim/pictures/pictures.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim::pictures {

// Sixteen fields of 4x4: eight widths, each once with upright and once with lying bars. Widths are in pixels of a
// 160x160 picture and grow with it.
hal::Image bars(int rows, int cols, std::uint64_t seed) {
  constexpr std::array widths{1, 2, 3, 4, 5, 6, 8, 10};
  struct Field {
    int width;
    bool upright;
  };
  std::array<Field, 16> fields{};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::size_t column = i % 4, line = i / 4;
    fields[i] = {widths[(line / 2) * 4 + column], line % 2 == 0};
  }
  if (seed != 0) {
    RandomStream random({seed, Draws::picture, 0, 3});
    for (std::size_t i = fields.size() - 1; i > 0; --i) {
      std::swap(fields[i], fields[random.below(static_cast<std::uint32_t>(i + 1))]);
    }
  }
  const int side = std::min(rows, cols);
  const int cell = std::max(side / 4, 1), margin = cell / 10;
  const int top = std::max((rows - 4 * cell) / 2, 0), left = std::max((cols - 4 * cell) / 2, 0);
  const int usable = std::max(cell - 2 * margin, 1);
  hal::Image picture(rows, cols);
  for (int row = top; row < std::min(rows, top + 4 * cell); ++row) {
    for (int col = left; col < std::min(cols, left + 4 * cell); ++col) {
      const int at = (row - top) / cell * 4 + (col - left) / cell;
      const Field& field = fields[static_cast<std::size_t>(at)];
      const int v = (row - top) % cell - margin, u = (col - left) % cell - margin;
      if (u < 0 || v < 0 || u >= usable || v >= usable) continue;
      const int width = std::max((field.width * side + 80) / 160, 1);
      // Only whole bars: a cut one would pretend to a pitch that is not in the picture.
      const int pairs = std::max((usable + width) / (2 * width), 1);
      const int across = field.upright ? u : v;
      if (across / width % 2 == 0 && across < (2 * pairs - 1) * width) picture.at(row, col) = 1.0F;
    }
  }
  return picture;
}

}  // namespace compueye::sim::pictures
