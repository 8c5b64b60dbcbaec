#include <algorithm>
#include <array>

#include "sim/pictures/pictures.hpp"

namespace compueye::sim::pictures {
namespace {

constexpr int sectors_a_quadrant = 18;  // of 5 degrees: 36 dark spokes and 36 light ones all round

struct Direction {
  double cosine = 1.0, sine = 0.0;
};

/// The borders between the sectors of a quadrant, by turning on by 5 degrees.
constexpr std::array<Direction, sectors_a_quadrant> borders = [] {
  constexpr double c = 0.99619469809174553, s = 0.087155742747658174;  // cos and sin of 5 degrees
  std::array<Direction, sectors_a_quadrant> all{};
  for (std::size_t k = 1; k < all.size(); ++k) {
    all[k] = {c * all[k - 1].cosine - s * all[k - 1].sine, s * all[k - 1].cosine + c * all[k - 1].sine};
  }
  return all;
}();

/// Which of the 72 sectors a point lies in, told by its quadrant and the borders that it is beyond.
int sector_of(double x, double y) noexcept {
  const double u = x < 0.0 ? -x : x, v = y < 0.0 ? -y : y;
  int low = 0, high = sectors_a_quadrant;  // beyond border `low`, not beyond `high`
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    const Direction& border = borders[static_cast<std::size_t>(middle)];
    (v * border.cosine > u * border.sine ? low : high) = middle;
  }
  const int quadrant = (x < 0.0 ? 2 : 0) + (y < 0.0 ? 1 : 0);
  return quadrant * sectors_a_quadrant + low;
}

/// A quadrant has an even number of sectors, so that its mirror image has light and dark exchanged.
bool is_light(double x, double y) noexcept {
  const bool odd = sector_of(x, y) % 2 != 0;
  return odd != ((x < 0.0) != (y < 0.0));
}

/// How much of the pixel with its upper left corner here is light.
float light_share(double x, double y) noexcept {
  const int sector = sector_of(x, y);
  const bool whole =
      sector == sector_of(x + 1.0, y) && sector == sector_of(x, y + 1.0) && sector == sector_of(x + 1.0, y + 1.0);
  if (whole) return is_light(x + 0.5, y + 0.5) ? 1.0F : 0.0F;
  constexpr int side = 8;
  int light = 0;
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) light += is_light(x + (col + 0.5) / side, y + (row + 0.5) / side) ? 1 : 0;
  }
  return static_cast<float>(light) / (side * side);
}

}  // namespace

hal::Image siemens_star(int rows, int cols) {
  const double radius = 0.48 * std::min(rows, cols);
  hal::Image picture(rows, cols);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const double x = col - cols / 2.0, y = row - rows / 2.0;
      const double distance2 = (x + 0.5) * (x + 0.5) + (y + 0.5) * (y + 0.5);
      if (distance2 <= radius * radius) picture.at(row, col) = light_share(x, y);
    }
  }
  return picture;
}

hal::Image slanted_edge(int rows, int cols, std::uint64_t seed) {
  constexpr double tangent = 0.087488663525924005;  // of 5 degrees
  constexpr double dark = 0.1, light = 0.9;
  // Integral of a pixel's lit width, which grows from 0 to 1 while the edge crosses it.
  const auto lit = [](double t) { return t <= 0.0 ? 0.0 : t <= 1.0 ? t * t / 2.0 : t - 0.5; };
  hal::Image picture(rows, cols);
  for (int row = 0; row < rows; ++row) {
    const double edge = cols / 2.0 + tangent * (row - rows / 2.0);  // where it enters the row
    for (int col = 0; col < cols; ++col) {
      const double right = col + 1.0 - edge;
      const double share = (lit(right) - lit(right - tangent)) / tangent;
      const double of_light = seed % 2 == 0 ? share : 1.0 - share;
      picture.at(row, col) = static_cast<float>(dark + (light - dark) * of_light);
    }
  }
  return picture;
}

}  // namespace compueye::sim::pictures
