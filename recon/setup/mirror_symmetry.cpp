#include "recon/setup/mirror_symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace compueye::recon {
namespace {

using Permutation = std::vector<std::int32_t>;
using CentroidKey = std::pair<std::int64_t, std::int64_t>;

struct Flip {
  bool left_right = false;
  bool up_down = false;
  bool transposed = false;
};

/// Finds, for every row, the row that is its mirror image: candidates by the centroid of their receptive fields, then
/// entry by entry.
class MirrorSearch {
 public:
  MirrorSearch(const Response& response)
      : response_(response), image_rows_(response.image_rows()), image_cols_(response.image_cols()) {
    mirrored_.resize(static_cast<std::size_t>(response.cols()));
    flipped_.resize(static_cast<std::size_t>(response.cols()));
    double largest = 0.0;
    for (int m = 0; m < response.rows(); ++m) {
      centroids_.push_back(centroid(m));
      rows_at_[key(centroids_.back())].push_back(m);
      response.for_each_in_row(m, [&](std::int32_t, double v) { largest = std::max(largest, std::abs(v)); });
    }
    tolerance_ = 1e-11 * largest;
  }

  [[nodiscard]] std::optional<Permutation> find(Flip flip) {
    for (std::int32_t n = 0; n < response_.cols(); ++n) flipped_[static_cast<std::size_t>(n)] = flipped(n, flip);
    Permutation permutation(static_cast<std::size_t>(response_.rows()), -1);
    for (int m = 0; m < response_.rows(); ++m) {
      if (permutation[static_cast<std::size_t>(m)] >= 0) continue;
      const std::optional<int> image = image_of(m, flip);
      // A flip is its own inverse: the image of a row's image is that row.
      if (!image || permutation[static_cast<std::size_t>(*image)] >= 0) return std::nullopt;
      permutation[static_cast<std::size_t>(m)] = *image;
      permutation[static_cast<std::size_t>(*image)] = m;
    }
    return permutation;
  }

 private:
  struct Point {
    double row = 0.0, col = 0.0;
  };

  [[nodiscard]] Point centroid(int m) const {
    double sum = 0.0, by_row = 0.0, by_col = 0.0;
    std::int32_t row = 0, row_begin = 0;
    response_.for_each_in_row(m, [&](std::int32_t n, double v) {
      // Columns ascend, and a division is slower than everything else here.
      for (; n >= row_begin + image_cols_; row_begin += image_cols_) ++row;
      sum += std::abs(v);
      by_row += std::abs(v) * row;
      by_col += std::abs(v) * (n - row_begin);
    });
    if (!(sum > 0.0)) return {};
    return {by_row / sum, by_col / sum};
  }

  [[nodiscard]] static CentroidKey key(Point p) { return {std::llround(p.row * 1e5), std::llround(p.col * 1e5)}; }

  [[nodiscard]] std::int32_t flipped(std::int32_t n, Flip flip) const {
    const std::int32_t row = n / image_cols_, col = n % image_cols_;
    if (flip.transposed) return col * image_cols_ + row;
    return (flip.up_down ? image_rows_ - 1 - row : row) * image_cols_ + (flip.left_right ? image_cols_ - 1 - col : col);
  }

  [[nodiscard]] double& mirrored_at(std::int32_t n) {
    return mirrored_[static_cast<std::size_t>(flipped_[static_cast<std::size_t>(n)])];
  }

  [[nodiscard]] std::optional<int> image_of(int m, Flip flip) {
    Point p = centroids_[static_cast<std::size_t>(m)];
    if (flip.up_down) p.row = image_rows_ - 1 - p.row;
    if (flip.left_right) p.col = image_cols_ - 1 - p.col;
    if (flip.transposed) std::swap(p.row, p.col);
    const CentroidKey at = key(p);
    response_.for_each_in_row(m, [&](std::int32_t n, double v) { mirrored_at(n) = v; });
    std::optional<int> found;
    for (std::int64_t dr = -1; dr <= 1 && !found; ++dr) {
      for (std::int64_t dc = -1; dc <= 1 && !found; ++dc) {
        const auto candidates = rows_at_.find({at.first + dr, at.second + dc});
        if (candidates == rows_at_.end()) continue;
        for (const int candidate : candidates->second) {
          if (!found && equals_mirrored(candidate, m)) found = candidate;
        }
      }
    }
    response_.for_each_in_row(m, [&](std::int32_t n, double) { mirrored_at(n) = 0.0; });
    return found;
  }

  [[nodiscard]] bool equals_mirrored(int candidate, int original) const {
    double difference = 0.0, sum = 0.0, original_sum = 0.0;
    response_.for_each_in_row(candidate, [&](std::int32_t n, double v) {
      difference = std::max(difference, std::abs(v - mirrored_[static_cast<std::size_t>(n)]));
      sum += v * v;
    });
    response_.for_each_in_row(original, [&](std::int32_t, double v) { original_sum += v * v; });
    // The candidate's entries all agree; equal norms exclude entries that only the original has.
    return difference <= tolerance_ && std::abs(sum - original_sum) <= 1e-9 * original_sum;
  }

  const Response& response_;
  int image_rows_;
  int image_cols_;
  std::map<CentroidKey, std::vector<int>> rows_at_;
  std::vector<Point> centroids_;
  std::vector<std::int32_t> flipped_;  // by the flip that is looked for
  std::vector<double> mirrored_;
  double tolerance_ = 0.0;
};

MirrorSymmetry no_symmetry(int rows) {
  Permutation identity(static_cast<std::size_t>(rows));
  std::iota(identity.begin(), identity.end(), 0);
  return {{std::move(identity)}, {{1}}};
}

}  // namespace

MirrorSymmetry find_mirror_symmetry(const Response& response) {
  MirrorSymmetry symmetry = no_symmetry(response.rows());
  if (response.image_cols() == 0) return symmetry;
  MirrorSearch search(response);
  const auto left_right = search.find({.left_right = true});
  const auto up_down = search.find({.up_down = true});
  if (left_right) {
    symmetry.permutations.push_back(*left_right);
    symmetry.characters = {{1, 1}, {1, -1}};
  }
  if (up_down) {
    symmetry.permutations.push_back(*up_down);
    symmetry.characters = {{1, 1}, {1, -1}};
  }
  if (left_right && up_down) {
    Permutation both(left_right->size());
    for (std::size_t m = 0; m < both.size(); ++m) both[m] = (*left_right)[static_cast<std::size_t>((*up_down)[m])];
    symmetry.permutations.push_back(std::move(both));
    symmetry.characters = {{1, 1, 1, 1}, {1, -1, 1, -1}, {1, 1, -1, -1}, {1, -1, -1, 1}};
  }
  return symmetry;
}

std::vector<std::int32_t> find_diagonal_symmetry(const Response& response) {
  if (response.image_cols() == 0 || response.image_rows() != response.image_cols()) return {};
  return MirrorSearch(response).find({.transposed = true}).value_or(Permutation{});
}

ParityClasses::ParityClasses(int rows, MirrorSymmetry symmetry) : symmetry_(std::move(symmetry)) {
  find_orbits(rows);
  find_positions();
}

ParityClasses::ParityClasses(int rows) : ParityClasses(rows, no_symmetry(rows)) {}

double ParityClasses::share(std::size_t c, int m) const noexcept {
  const Place place = places_[static_cast<std::size_t>(m)];
  const int sign = symmetry_.characters[c][static_cast<std::size_t>(place.element)];
  return sign * orbits_[static_cast<std::size_t>(place.orbit)].component;
}

void ParityClasses::find_orbits(int rows) {
  places_.assign(static_cast<std::size_t>(rows), {-1, 0});
  for (int m = 0; m < rows; ++m) {
    if (places_[static_cast<std::size_t>(m)].orbit >= 0) continue;
    Orbit orbit{m, 0, 0.0};
    for (std::size_t g = 0; g < symmetry_.order(); ++g) {
      const auto image = static_cast<std::size_t>(symmetry_.permutations[g][static_cast<std::size_t>(m)]);
      if (image == static_cast<std::size_t>(m)) ++orbit.stabiliser;
      if (places_[image].orbit < 0) places_[image] = {static_cast<int>(orbits_.size()), static_cast<int>(g)};
    }
    orbit.component = std::sqrt(orbit.stabiliser / static_cast<double>(symmetry_.order()));
    orbits_.push_back(orbit);
  }
}

/// A class has a component on an orbit only when its sign is +1 on everything that leaves the orbit's row in place.
void ParityClasses::find_positions() {
  for (const std::vector<int>& signs : symmetry_.characters) {
    std::vector<int> positions;
    int size = 0;
    for (const Orbit& orbit : orbits_) {
      bool present = true;
      for (std::size_t g = 0; g < symmetry_.order(); ++g) {
        const bool fixed = symmetry_.permutations[g][static_cast<std::size_t>(orbit.first)] == orbit.first;
        present = present && (!fixed || signs[g] == 1);
      }
      positions.push_back(present ? size++ : -1);
    }
    positions_.push_back(std::move(positions));
    orders_.push_back(size);
  }
}

}  // namespace compueye::recon
