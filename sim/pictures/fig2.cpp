#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "sim/pictures/pictures.hpp"

namespace compueye::sim::pictures {

hal::Result<hal::Image> fig2(int rows, int cols) {
  constexpr std::array<std::string_view, 16> pattern{
      "................",  //
      "................",  //
      "................",  //
      "....##....##....",  //
      "....##....##....",  //
      "................",  //
      ".......#........",  //
      ".......##.......",  //
      "................",  //
      "....#......#....",  //
      ".....#....#.....",  //
      "......####......",  //
      "................",  //
      "................",  //
      "................",  //
      "................",
  };
  constexpr int side = static_cast<int>(pattern.size());
  const int replication = std::min(rows, cols) / side;
  if (replication < 1) {
    return hal::fail(hal::ErrorCode::out_of_range, "scene 'fig2'",
                     "asked for " + std::to_string(rows) + "x" + std::to_string(cols) + " pixels, expected at least " +
                         std::to_string(side) + "x" + std::to_string(side));
  }
  const int top = (rows - replication * side) / 2, left = (cols - replication * side) / 2;
  hal::Image picture(rows, cols);
  for (int row = 0; row < replication * side; ++row) {
    for (int col = 0; col < replication * side; ++col) {
      const std::string_view line = pattern[static_cast<std::size_t>(row / replication)];
      if (line[static_cast<std::size_t>(col / replication)] == '#') picture.at(top + row, left + col) = 1.0F;
    }
  }
  return picture;
}

}  // namespace compueye::sim::pictures
