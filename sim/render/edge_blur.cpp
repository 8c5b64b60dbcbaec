#include "sim/render/edge_blur.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace compueye::sim {
namespace {

/// Shares of the pixel before in the mean over each part of a pixel; of the pixel behind they are the same from its
/// end.
std::vector<float> shares_of_neighbour(double share, int parts) {
  // The neighbour has (half - x) / share of the light at x after the edge, whose integral from x on is this.
  const double half = 0.5 * share;
  const auto rest = [&](double x) {
    const double left = std::max(0.0, half - x);
    return 0.5 * left * left / share;
  };
  std::vector<float> shares;
  for (int k = 0; k < parts; ++k) {
    shares.push_back(static_cast<float>((rest(static_cast<double>(k) / parts) - rest((k + 1.0) / parts)) * parts));
  }
  return shares;
}

}  // namespace

hal::Image with_blurred_edges(const hal::Image& picture, double share, int finer) {
  const std::vector<float> shares = shares_of_neighbour(share, finer);
  const int rows = picture.rows + 2, cols = picture.cols + 2;
  const auto mixed = [&](float before, float here, float behind, int part) {
    const float first = shares[static_cast<std::size_t>(part)];
    const float last = shares[static_cast<std::size_t>(finer - 1 - part)];
    return here + first * (before - here) + last * (behind - here);
  };
  hal::Image across(rows, cols * finer);
  for (int row = 0; row < picture.rows; ++row) {
    const auto at = [&](int col) { return col < 0 || col >= picture.cols ? 0.0F : picture.at(row, col); };
    for (int col = 0; col < cols; ++col) {
      for (int part = 0; part < finer; ++part) {
        across.at(row + 1, col * finer + part) = mixed(at(col - 2), at(col - 1), at(col), part);
      }
    }
  }
  hal::Image blurred(rows * finer, cols * finer);
  for (int row = 0; row < rows; ++row) {
    for (int part = 0; part < finer; ++part) {
      for (int col = 0; col < blurred.cols; ++col) {
        const float before = row > 0 ? across.at(row - 1, col) : 0.0F;
        const float behind = row + 1 < rows ? across.at(row + 1, col) : 0.0F;
        blurred.at(row * finer + part, col) = mixed(before, across.at(row, col), behind, part);
      }
    }
  }
  return blurred;
}

int parts_for_blur(const hal::Image& picture, double share) noexcept {
  const int room = std::max(1, 4096 / (std::max(picture.rows, picture.cols) + 2));
  return static_cast<int>(std::min(static_cast<double>(room), std::ceil(8.0 / share)));
}

}  // namespace compueye::sim
