#include "sim/render/picture_sums.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace compueye::sim {
namespace {

constexpr int most_nodes = 5;

/// Integral over [a, b] of each Lagrange polynomial of the rule's points, halved: an even tile -1 .. 1 has sum 1.
std::array<double, most_nodes> lagrange_shares(const GaussRule& rule, int nodes, double a, double b) {
  const GaussRule& exact = gauss_rule(3);  // to degree 5, one more than needed
  std::array<double, most_nodes> shares{};
  for (std::size_t q = 0; q < 3; ++q) {
    const double x = 0.5 * (a + b) + 0.5 * (b - a) * exact.at[q];
    for (int k = 0; k < nodes; ++k) {
      double basis = 1.0;
      for (int j = 0; j < nodes; ++j) {
        if (j == k) continue;
        const auto at_j = rule.at[static_cast<std::size_t>(j)], at_k = rule.at[static_cast<std::size_t>(k)];
        basis *= (x - at_j) / (at_k - at_j);
      }
      shares[static_cast<std::size_t>(k)] += 0.25 * (b - a) * exact.weight[q] * basis;
    }
  }
  return shares;
}

bool all_alike(const hal::Image& picture, int row0, int col0, int down, int across) {
  const float first = picture.at(row0, col0);
  for (int row = row0; row < row0 + down; ++row) {
    for (int col = col0; col < col0 + across; ++col) {
      if (picture.at(row, col) != first) return false;
    }
  }
  return true;
}

/// One row of shares a pixel of a tile `count` pixels long.
std::vector<std::array<double, most_nodes>> pixel_shares(int nodes, int count) {
  std::vector<std::array<double, most_nodes>> shares;
  for (int p = 0; p < count; ++p) {
    shares.push_back(lagrange_shares(gauss_rule(nodes), nodes, 2.0 * p / count - 1.0, 2.0 * (p + 1) / count - 1.0));
  }
  return shares;
}

}  // namespace

const GaussRule& gauss_rule(int count) noexcept {
  static constexpr std::array<GaussRule, 5> rules{{
      {{0.0}, {2.0}},
      {{-0.57735026918962576, 0.57735026918962576}, {1.0, 1.0}},
      {{-0.77459666924148338, 0.0, 0.77459666924148338}, {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0}},
      {{-0.86113631159405258, -0.33998104358485626, 0.33998104358485626, 0.86113631159405258},
       {0.34785484513745386, 0.65214515486254614, 0.65214515486254614, 0.34785484513745386}},
      {{-0.90617984593866399, -0.53846931010568309, 0.0, 0.53846931010568309, 0.90617984593866399},
       {0.23692688505618909, 0.47862867049936647, 128.0 / 225.0, 0.47862867049936647, 0.23692688505618909}},
  }};
  return rules[static_cast<std::size_t>(count - 1)];
}

PictureSums::PictureSums(const hal::Image& picture, double width_mm, double height_mm, bool tiles)
    : rows_(picture.rows),
      cols_(picture.cols),
      left_(-width_mm / 2.0),
      top_(height_mm / 2.0),
      pixel_width_(width_mm / cols_),
      pixel_height_(height_mm / rows_),
      sums_(start(rows_)) {
  for (int row = 0; row < rows_; ++row) {
    double* sums = sums_.data() + start(row);
    for (int col = 0; col < cols_; ++col) sums[col + 1] = sums[col] + static_cast<double>(picture.at(row, col));
  }
  if (!tiles) return;
  int size = 4;
  while (true) {
    add_level(picture, size);
    if (size >= std::max(rows_, cols_)) return;
    size *= 4;
  }
}

void PictureSums::add_level(const hal::Image& picture, int size) {
  Level level;
  level.size = size;
  level.rows = (rows_ + size - 1) / size;
  level.cols = (cols_ + size - 1) / size;
  level.nodes = size == 4 ? 3 : most_nodes;
  const auto nodes = static_cast<std::size_t>(level.nodes);
  const GaussRule& rule = gauss_rule(level.nodes);
  std::vector<double> masses(nodes * nodes);
  for (int tile = 0; tile < level.rows * level.cols; ++tile) {
    const int row0 = tile / level.cols * size, col0 = tile % level.cols * size;
    const int down = std::min(size, rows_ - row0), across = std::min(size, cols_ - col0);
    const auto of_row = pixel_shares(level.nodes, down), of_col = pixel_shares(level.nodes, across);
    std::fill(masses.begin(), masses.end(), 0.0);
    double total = 0.0;
    for (int r = 0; r < down; ++r) {
      std::array<double, most_nodes> along{};
      for (int c = 0; c < across; ++c) {
        const double value_here = value(row0 + r, col0 + c);
        total += value_here;
        for (std::size_t k = 0; k < nodes; ++k) along[k] += value_here * of_col[static_cast<std::size_t>(c)][k];
      }
      const auto& share = of_row[static_cast<std::size_t>(down - 1 - r)];  // upwards
      for (std::size_t j = 0; j < nodes; ++j) {
        for (std::size_t k = 0; k < nodes; ++k) masses[j * nodes + k] += share[j] * along[k] * down * across;
      }
    }
    double uneven = 0.0;
    for (std::size_t j = 0; j < nodes; ++j) {
      for (std::size_t k = 0; k < nodes; ++k) {
        uneven += std::fabs(masses[j * nodes + k] - total * rule.weight[j] * rule.weight[k] / 4.0);
      }
    }
    level.masses.insert(level.masses.end(), masses.begin(), masses.end());
    level.total.push_back(total);
    level.uneven.push_back(uneven);
    level.one_value.push_back(all_alike(picture, row0, col0, down, across));
  }
  levels_.push_back(std::move(level));
}

}  // namespace compueye::sim
