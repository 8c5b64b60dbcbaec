#include "recon/running_sum_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace compueye::recon {
namespace {

/// One row of A, folded: visits its taps lane by lane, elements ascending.
class FoldedRow {
 public:
  FoldedRow(const Response& response, int image_rows, int image_cols, double negligible_share)
      : response_(response),
        rows_(image_rows),
        cols_(image_cols),
        half_cols_((image_cols + 1) / 2),
        picture_(static_cast<std::size_t>(image_rows) * static_cast<std::size_t>(image_cols), 0.0) {
    double largest = 0.0;
    for (const double v : response.values()) largest = std::max(largest, std::abs(v));
    negligible_ = negligible_share * largest;
  }

  /// Calls visit(element, difference) for every tap of row m in lane q.
  template <class Visit>
  void for_each_tap(int m, std::size_t lane, Visit&& visit) {
    spread(m, true);
    const int half_rows = (rows_ + 1) / 2;
    for (int r = 0; r < half_rows; ++r) {
      for (int c = 0; c < half_cols_; ++c) {
        const double difference = coverage(lane, r, c) - coverage(lane, r, c + 1);
        if (std::abs(difference) > negligible_) visit(r * half_cols_ + c, difference);
      }
    }
    spread(m, false);
  }

 private:
  void spread(int m, bool in) {
    response_.for_each_in_row(m,
                              [&](std::int32_t n, double v) { picture_[static_cast<std::size_t>(n)] = in ? v : 0.0; });
  }

  [[nodiscard]] double coverage(std::size_t lane, int r, int c) const {
    const int row = (lane & 2U) != 0 ? rows_ / 2 + r : rows_ / 2 - 1 - r;
    const int col = (lane & 1U) != 0 ? cols_ / 2 + c : cols_ / 2 - 1 - c;
    if (row < 0 || row >= rows_ || col < 0 || col >= cols_) return 0.0;
    return picture_[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) + static_cast<std::size_t>(col)];
  }

  const Response& response_;
  int rows_;
  int cols_;
  int half_cols_;
  std::vector<double> picture_;
  double negligible_ = 0.0;
};

/// First rows of the orbits, and the row in each lane: the image under a flip left-right, up-down and both.
struct Orbits {
  std::vector<std::int32_t> first;
  std::vector<std::int32_t> row;
};

Orbits orbits_of(int rows, const MirrorSymmetry& symmetry) {
  Orbits orbits;
  std::vector<bool> placed(static_cast<std::size_t>(rows), false);
  for (std::int32_t m = 0; m < rows; ++m) {
    if (placed[static_cast<std::size_t>(m)]) continue;
    orbits.first.push_back(m);
    for (const auto& permutation : symmetry.permutations) {
      const std::int32_t image = permutation[static_cast<std::size_t>(m)];
      orbits.row.push_back(placed[static_cast<std::size_t>(image)] ? -1 : image);
      placed[static_cast<std::size_t>(image)] = true;
    }
  }
  return orbits;
}

}  // namespace

bool running_sums_fit(int image_rows, int image_cols) noexcept {
  const std::int64_t half_rows = (image_rows + 1) / 2, half_cols = (image_cols + 1) / 2;
  return half_rows * half_cols <= 65536;
}

template <class T>
std::optional<RunningSumTables<T>> running_sum_tables(const Response& seeing, int image_rows, int image_cols,
                                                      const MirrorSymmetry& symmetry) {
  if (!running_sums_fit(image_rows, image_cols)) return std::nullopt;
  RunningSumTables<T> tables;
  const bool symmetric = symmetry.order() == 4 && image_rows % 2 == 0 && image_cols % 2 == 0;
  std::vector<std::int32_t> firsts;
  if (symmetric) {
    Orbits orbits = orbits_of(seeing.rows(), symmetry);
    firsts = std::move(orbits.first);
    tables.row = std::move(orbits.row);
  } else {
    for (std::int32_t m = 0; m < seeing.rows(); ++m) firsts.push_back(m);
  }
  FoldedRow folded(seeing, image_rows, image_cols, 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon()));
  tables.first.push_back(0);
  for (const std::int32_t m : firsts) {
    for (std::size_t lane = 0; lane < 4; ++lane) {
      folded.for_each_tap(m, lane, [&](int element, double difference) {
        tables.element.push_back(static_cast<std::uint16_t>(element));
        tables.difference.push_back(static_cast<T>(difference));
      });
      tables.first.push_back(static_cast<std::uint32_t>(tables.element.size()));
    }
  }
  tables.view = {symmetric,
                 static_cast<std::size_t>(image_rows),
                 static_cast<std::size_t>(image_cols),
                 firsts.size(),
                 tables.first.data(),
                 tables.element.data(),
                 tables.difference.data(),
                 tables.row.data()};
  return tables;
}

std::int64_t running_sum_taps(const Response& seeing, int image_rows, int image_cols) {
  FoldedRow folded(seeing, image_rows, image_cols, 0.5 * static_cast<double>(std::numeric_limits<float>::epsilon()));
  std::int64_t taps = 0;
  for (int m = 0; m < seeing.rows(); ++m) {
    for (std::size_t lane = 0; lane < 4; ++lane) folded.for_each_tap(m, lane, [&](int, double) { ++taps; });
  }
  return taps;
}

template std::optional<RunningSumTables<float>> running_sum_tables(const Response&, int, int, const MirrorSymmetry&);
template std::optional<RunningSumTables<double>> running_sum_tables(const Response&, int, int, const MirrorSymmetry&);

}  // namespace compueye::recon
