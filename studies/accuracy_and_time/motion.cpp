#include "studies/accuracy_and_time/motion.hpp"

#include <algorithm>

namespace compueye::firmware {

std::string_view name(Motion motion) noexcept {
  switch (motion) {
    case Motion::none:
      return "none";
    case Motion::still:
      return "still";
    case Motion::sprite:
      return "sprite";
  }
  return "none";
}

hal::Image before_arrival(const hal::Image& scene, std::size_t frames) {
  constexpr int pieces = 4, steps = 80;
  const int side = std::max(std::min(scene.rows, scene.cols) / pieces, 1);
  const int top = (scene.rows - side) / 2, left = (scene.cols - side) / 2;
  const int shift = std::max(scene.cols / steps, 1) * static_cast<int>(frames);
  hal::Image picture = scene;
  for (int row = top; row < top + side; ++row) {
    for (int col = left; col < left + side; ++col) picture.at(row, col) = 0.0F;
  }
  for (int row = top; row < top + side; ++row) {
    for (int col = left; col < std::min(left + side, scene.cols - shift); ++col) {
      picture.at(row, col + shift) = scene.at(row, col);
    }
  }
  return picture;
}

}  // namespace compueye::firmware
