#include "recon/setup/running_sum_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace compueye::recon {
namespace {

/// Rows of A, folded: visits the taps of one lane by lane, elements ascending.
class SpreadRow {
 public:
  SpreadRow(const Response& response, double negligible_share)
      : response_(response),
        rows_(response.image_rows()),
        cols_(response.image_cols()),
        half_cols_((response.image_cols() + 1) / 2),
        picture_(static_cast<std::size_t>(response.image_rows()) * static_cast<std::size_t>(response.image_cols()),
                 0.0) {
    double largest = 0.0;
    for (const double v : response.values()) largest = std::max(largest, std::abs(v));
    negligible_ = negligible_share * largest;
  }

  /// Calls visit(lane, element, difference) for every tap of row m, lane by lane.
  template <class Visit>
  void for_each_tap(int m, Visit&& visit) {
    std::int32_t first = -1, last = -1;
    response_.for_each_in_row(m, [&](std::int32_t n, double v) {
      picture_[static_cast<std::size_t>(n)] = v;
      if (first < 0) first = n;
      last = n;
    });
    // Rows of the picture that this ommatidium does not see have no taps.
    for (std::size_t lane = 0; lane < lanes && first >= 0; ++lane) {
      for_each_in_lane(lane, first / cols_, last / cols_, visit);
    }
    response_.for_each_in_row(m, [&](std::int32_t n, double) { picture_[static_cast<std::size_t>(n)] = 0.0; });
  }

  static constexpr std::size_t lanes = 4;

 private:
  template <class Visit>
  void for_each_in_lane(std::size_t lane, int first_row, int last_row, Visit&& visit) const {
    const int half_rows = (rows_ + 1) / 2;
    for (int r = 0; r < half_rows; ++r) {
      if (row_of(lane, r) < first_row || row_of(lane, r) > last_row) continue;
      for (int c = 0; c < half_cols_; ++c) {
        const double difference = coverage(lane, r, c) - coverage(lane, r, c + 1);
        if (std::abs(difference) > negligible_) visit(lane, r * half_cols_ + c, difference);
      }
    }
  }

  [[nodiscard]] int row_of(std::size_t lane, int r) const noexcept {
    return (lane & 2U) != 0 ? rows_ / 2 + r : rows_ / 2 - 1 - r;
  }

  [[nodiscard]] double coverage(std::size_t lane, int r, int c) const {
    const int row = row_of(lane, r);
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

/// First rows of the orbits, and the row in each lane: the image under a flip left-right, up-down and both, then the
/// transposed images of those.
struct Orbits {
  std::vector<std::int32_t> first;
  std::vector<std::int32_t> row;
};

Orbits orbits_of(int rows, const MirrorSymmetry& symmetry, const std::vector<std::int32_t>& transposed, bool eight) {
  Orbits orbits;
  std::vector<bool> placed(static_cast<std::size_t>(rows), false);
  const auto place = [&](std::int32_t image) {
    orbits.row.push_back(placed[static_cast<std::size_t>(image)] ? -1 : image);
    placed[static_cast<std::size_t>(image)] = true;
  };
  for (std::int32_t m = 0; m < rows; ++m) {
    if (placed[static_cast<std::size_t>(m)]) continue;
    orbits.first.push_back(m);
    for (const auto& permutation : symmetry.permutations) place(permutation[static_cast<std::size_t>(m)]);
    for (const auto& permutation : symmetry.permutations) {
      if (eight) place(transposed[static_cast<std::size_t>(permutation[static_cast<std::size_t>(m)])]);
    }
  }
  return orbits;
}

/// Bands of folded rows with about as many taps each: twelve where the picture is large, as many as two, three or four
/// workers can share evenly.
std::vector<std::uint32_t> band_rows(const std::vector<std::uint16_t>& elements, int half_rows, int half_cols) {
  constexpr std::size_t many = 12, worth_it = 96 * 96 / 4;
  const std::size_t bands = half_rows * half_cols >= static_cast<int>(worth_it) && half_rows >= static_cast<int>(many)
                                ? many
                                : std::size_t{1};
  std::vector<std::size_t> taps(static_cast<std::size_t>(half_rows), 0);
  for (const std::uint16_t element : elements) ++taps[element / static_cast<std::size_t>(half_cols)];
  std::vector<std::uint32_t> begins{0};
  std::size_t sum = 0;
  for (std::size_t r = 0; r < taps.size() && begins.size() < bands; ++r) {
    sum += taps[r];
    if (sum * bands >= begins.size() * elements.size()) begins.push_back(static_cast<std::uint32_t>(r + 1));
  }
  while (begins.size() <= bands) begins.push_back(static_cast<std::uint32_t>(half_rows));
  return begins;
}

/// Where every lane of every table begins, refined by bands; `ends` are those of the lanes.
std::vector<std::uint32_t> banded(const std::vector<std::uint32_t>& lane_first,
                                  const std::vector<std::uint16_t>& elements,
                                  const std::vector<std::uint32_t>& band_row, int half_cols) {
  std::vector<std::uint32_t> first;
  for (std::size_t lane = 0; lane + 1 < lane_first.size(); ++lane) {
    std::uint32_t k = lane_first[lane];
    for (std::size_t band = 0; band + 1 < band_row.size(); ++band) {
      const auto begin = band_row[band] * static_cast<std::uint32_t>(half_cols);
      while (k < lane_first[lane + 1] && elements[k] < begin) ++k;
      first.push_back(k);
    }
  }
  first.push_back(lane_first.back());
  return first;
}

}  // namespace

bool running_sums_fit(int image_rows, int image_cols) noexcept {
  const std::int64_t half_rows = (image_rows + 1) / 2, half_cols = (image_cols + 1) / 2;
  return image_rows > 0 && image_cols > 0 && half_rows * half_cols <= 65536;
}

int rows_sharing_tables(int image_rows, int image_cols, const MirrorSymmetry& symmetry,
                        const std::vector<std::int32_t>& transposed) noexcept {
  if (symmetry.order() != 4 || image_rows % 2 != 0 || image_cols % 2 != 0) return 1;
  return image_rows == image_cols && !transposed.empty() ? 8 : 4;
}

template <class T>
std::optional<RunningSumTables<T>> running_sum_tables(const Response& seeing, const MirrorSymmetry& symmetry,
                                                      const std::vector<std::int32_t>& transposed) {
  if (!running_sums_fit(seeing.image_rows(), seeing.image_cols())) return std::nullopt;
  const int half_rows = (seeing.image_rows() + 1) / 2, half_cols = (seeing.image_cols() + 1) / 2;
  const int at_once = rows_sharing_tables(seeing.image_rows(), seeing.image_cols(), symmetry, transposed);
  RunningSumTables<T> tables;
  std::vector<std::int32_t> firsts;
  if (at_once > 1) {
    Orbits orbits = orbits_of(seeing.rows(), symmetry, transposed, at_once == 8);
    firsts = std::move(orbits.first);
    tables.row = std::move(orbits.row);
  } else {
    for (std::int32_t m = 0; m < seeing.rows(); ++m) firsts.push_back(m);
  }
  SpreadRow spread(seeing, 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon()));
  std::vector<std::uint32_t> lane_first{0};
  for (const std::int32_t m : firsts) {
    std::array<std::uint32_t, SpreadRow::lanes> taps{};
    spread.for_each_tap(m, [&](std::size_t lane, int element, double difference) {
      tables.element.push_back(static_cast<std::uint16_t>(element));
      tables.difference.push_back(static_cast<T>(difference));
      ++taps[lane];
    });
    for (const std::uint32_t count : taps) lane_first.push_back(lane_first.back() + count);
  }
  tables.band_row = band_rows(tables.element, half_rows, half_cols);
  tables.first = banded(lane_first, tables.element, tables.band_row, half_cols);
  tables.view = {static_cast<std::size_t>(at_once),
                 static_cast<std::size_t>(seeing.image_rows()),
                 static_cast<std::size_t>(seeing.image_cols()),
                 firsts.size(),
                 tables.band_row.size() - 1,
                 tables.first.data(),
                 tables.element.data(),
                 tables.difference.data(),
                 tables.row.data(),
                 tables.band_row.data()};
  return tables;
}

std::int64_t running_sum_taps(const Response& seeing) {
  SpreadRow spread(seeing, 0.5 * static_cast<double>(std::numeric_limits<float>::epsilon()));
  std::int64_t taps = 0;
  for (int m = 0; m < seeing.rows(); ++m) spread.for_each_tap(m, [&](std::size_t, int, double) { ++taps; });
  return taps;
}

template std::optional<RunningSumTables<float>> running_sum_tables(const Response&, const MirrorSymmetry&,
                                                                   const std::vector<std::int32_t>&);
template std::optional<RunningSumTables<double>> running_sum_tables(const Response&, const MirrorSymmetry&,
                                                                    const std::vector<std::int32_t>&);

}  // namespace compueye::recon
