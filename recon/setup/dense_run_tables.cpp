#include "recon/setup/dense_run_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "recon/setup/quantised_response.hpp"

namespace compueye::recon {
namespace {

constexpr int group_pixels = 16;
constexpr int rows_at_once = 4;

/// What four rows see, pixel by pixel.
class Block {
 public:
  explicit Block(const Response& response)
      : response_(response), pixels_(static_cast<std::size_t>(response.cols()), std::array<double, 4>{}) {}

  void take(int first_row) {
    for (const std::int32_t n : seen_) pixels_[static_cast<std::size_t>(n)] = {};
    seen_.clear();
    for (int l = 0; l < rows_at_once && first_row + l < response_.rows(); ++l) {
      response_.for_each_in_row(first_row + l, [&](std::int32_t n, double v) {
        if (v == 0.0) return;
        pixels_[static_cast<std::size_t>(n)][static_cast<std::size_t>(l)] = v;
        seen_.push_back(n);
      });
    }
    std::sort(seen_.begin(), seen_.end());
    seen_.erase(std::unique(seen_.begin(), seen_.end()), seen_.end());
  }

  /// Pixels that any of the rows sees, ascending.
  [[nodiscard]] const std::vector<std::int32_t>& seen() const noexcept { return seen_; }
  [[nodiscard]] const std::array<double, 4>& at(int pixel) const { return pixels_[static_cast<std::size_t>(pixel)]; }

 private:
  const Response& response_;
  std::vector<std::array<double, 4>> pixels_;
  std::vector<std::int32_t> seen_;
};

/// Covers the seen pixels of one band, ascending, with groups: visit(first pixel, pixels to be left out of it because
/// an earlier group has them). The last group of a band ends with it and may reach back.
template <class Visit>
void cover(const std::int32_t* begin, const std::int32_t* end, int band_end, Visit&& visit) {
  int covered = 0;
  while (begin != end) {
    const int start = std::min<int>(*begin, band_end - group_pixels);
    visit(start, std::max(0, covered - start));
    covered = start + group_pixels;
    while (begin != end && *begin < covered) ++begin;
  }
}

/// Bands hold whole rows of pixels, twelve of them where the picture is large: as many as two, three or four workers
/// can share evenly.
std::vector<int> bands_of(int pixels, int image_cols) {
  constexpr int many = 12, worth_it = 96 * 96;
  std::vector<int> ends;
  const int rows = image_cols > 0 ? pixels / image_cols : 0;
  for (int band = 1; pixels >= worth_it && image_cols >= group_pixels && rows >= many && band < many; ++band) {
    ends.push_back(rows * band / many * image_cols);
  }
  ends.push_back(pixels);
  return ends;
}

/// Calls visit(band, first pixel, left out) for every group of the block that was taken.
template <class Visit>
void for_each_group(const Block& block, const std::vector<int>& band_ends, Visit&& visit) {
  const std::int32_t* at = block.seen().data();
  const std::int32_t* const end = at + block.seen().size();
  for (std::size_t band = 0; band < band_ends.size(); ++band) {
    const std::int32_t* const next = std::lower_bound(at, end, band_ends[band]);
    cover(at, next, band_ends[band], [&](int start, int left_out) { visit(band, start, left_out); });
    at = next;
  }
}

/// Appends to the tables block by block.
template <class T>
class Writer {
 public:
  Writer(const Response& seeing, core::RunValues stored, DenseRunTables<T>& tables)
      : seeing_(seeing), stored_(stored), t_(tables) {}

  void add(const Block& block, int first_row, const std::vector<int>& band_ends) {
    for (int l = 0; l < rows_at_once; ++l) start_row(first_row + l);
    std::size_t band = 0;
    const auto open_to = [&](std::size_t last) {
      for (; band < last; ++band) end_band();
    };
    for_each_group(block, band_ends, [&](std::size_t in_band, int start, int left_out) {
      open_to(in_band);
      add_group(block, start, left_out);
    });
    open_to(band_ends.size());
  }

  void begin() {
    t_.first.push_back(0);
    t_.group.push_back(0);
  }

 private:
  void start_row(int m) {
    const bool exists = m < seeing_.rows();
    t_.row.push_back(exists ? m : -1);
    if (stored_ != core::RunValues::int8) return;
    double largest = 0.0;
    if (exists) seeing_.for_each_in_row(m, [&](std::int32_t, double v) { largest = std::max(largest, std::abs(v)); });
    scale_[static_cast<std::size_t>(m) % rows_at_once] = int8_scale(largest);
    t_.scale.push_back(static_cast<T>(int8_scale(largest)));
  }

  void end_band() {
    t_.first.push_back(static_cast<std::uint32_t>(t_.start.size()));
    t_.group.push_back(groups_);
  }

  void add_group(const Block& block, int start, int left_out) {
    const bool new_band = t_.first.back() == t_.start.size();
    const bool longest = !new_band && t_.groups.back() == std::numeric_limits<std::uint16_t>::max();
    if (new_band || longest || start != run_end_) {
      t_.start.push_back(static_cast<std::uint32_t>(start));
      t_.groups.push_back(0);
    }
    ++t_.groups.back();
    ++groups_;
    run_end_ = start + group_pixels;
    constexpr std::array<double, 4> nothing{};
    std::array<std::array<double, 4>, group_pixels> pixels{};
    for (int k = 0; k < group_pixels; ++k) {
      pixels[static_cast<std::size_t>(k)] = k < left_out ? nothing : block.at(start + k);
    }
    add_values(pixels);
  }

  void add_values(const std::array<std::array<double, 4>, group_pixels>& pixels) {
    if (stored_ == core::RunValues::full) {
      for (std::size_t l = 0; l < 4; ++l) {
        for (const auto& rows : pixels) t_.values.push_back(kept(rows[l]));
      }
    } else if (stored_ == core::RunValues::bf16) {
      for (std::size_t l = 0; l < 4; l += 2) {
        for (const auto& rows : pixels) {
          t_.words.push_back(bf16_of(rows[l]) | static_cast<std::uint32_t>(bf16_of(rows[l + 1])) << 16U);
        }
      }
    } else {
      for (const auto& rows : pixels) {
        std::uint32_t word = 0;
        for (std::size_t l = 0; l < 4; ++l) {
          word |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(int8_of(rows[l], scale_[l]))) << (8U * l);
        }
        t_.words.push_back(word);
      }
    }
  }

  /// What only double can tell from nought would be a subnormal number in every product.
  static T kept(double value) {
    return std::abs(value) < static_cast<double>(std::numeric_limits<T>::min()) ? T(0) : static_cast<T>(value);
  }

  const Response& seeing_;
  core::RunValues stored_;
  DenseRunTables<T>& t_;
  std::array<float, 4> scale_{};
  std::uint32_t groups_ = 0;
  int run_end_ = -1;
};

}  // namespace

template <class T>
std::optional<DenseRunTables<T>> dense_run_tables(const Response& seeing, core::RunValues stored) {
  if (seeing.cols() < least_run_pixels) return std::nullopt;
  const std::vector<int> band_ends = bands_of(seeing.cols(), seeing.image_cols());
  DenseRunTables<T> tables;
  Block block(seeing);
  Writer<T> writer(seeing, stored, tables);
  writer.begin();
  for (int m = 0; m < seeing.rows(); m += rows_at_once) {
    block.take(m);
    writer.add(block, m, band_ends);
  }
  tables.view = {stored,
                 tables.row.size() / rows_at_once,
                 band_ends.size(),
                 tables.first.data(),
                 tables.group.data(),
                 tables.start.data(),
                 tables.groups.data(),
                 tables.row.data(),
                 tables.values.data(),
                 tables.words.data(),
                 tables.scale.data()};
  return tables;
}

std::int64_t dense_run_values(const Response& seeing) {
  if (seeing.cols() < least_run_pixels) return std::numeric_limits<std::int64_t>::max();
  const std::vector<int> band_ends = bands_of(seeing.cols(), seeing.image_cols());
  Block block(seeing);
  std::int64_t groups = 0;
  for (int m = 0; m < seeing.rows(); m += rows_at_once) {
    block.take(m);
    for_each_group(block, band_ends, [&](std::size_t, int, int) { ++groups; });
  }
  return groups * group_pixels * rows_at_once;
}

template std::optional<DenseRunTables<float>> dense_run_tables(const Response&, core::RunValues);
template std::optional<DenseRunTables<double>> dense_run_tables(const Response&, core::RunValues);

}  // namespace compueye::recon
