#include "recon/setup/wavelet_run_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "recon/core/parts/crew.hpp"
#include "recon/setup/like_rows.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/wavelet_rounding.hpp"

namespace compueye::recon {
namespace {

constexpr std::size_t tile = core::WaveletPicture::tile;
constexpr std::size_t rows_at_once = core::WaveletRuns<float>::rows_at_once;

/// The tiles that any of four rows has, and what each is in all of them.
struct Block {
  std::vector<std::uint16_t> place;                             ///< ascending
  std::vector<std::array<double, rows_at_once * tile>> values;  ///< row after row
  std::size_t averages = 0;                                     ///< how many of the tiles are of averages
  std::array<double, rows_at_once> largest{};                   ///< detail of each row
};

/// Rows of A by their tiles, four alike in a block.
class Blocks {
 public:
  explicit Blocks(const Response& seeing) {
    WaveletRows rows(seeing);
    shape_ = rows.shape();
    for (int m = 0; m < seeing.rows(); ++m) {
      rows.recover(m);
      auto& values = values_.emplace_back();
      auto& places = places_.emplace_back();
      for (const std::size_t t : rows.tiles()) {
        places.push_back(static_cast<std::uint16_t>(t));
        const auto begin = rows.coefficients().begin() + static_cast<std::ptrdiff_t>(t * tile);
        values.insert(values.end(), begin, begin + tile);
      }
    }
    order_ = in_groups_of_like_rows(places_, tiles(), rows_at_once);
  }

  [[nodiscard]] Block at(std::size_t b) const {
    Block block;
    for (std::size_t l = 0; l < rows_at_once && row(b, l) >= 0; ++l) {
      const auto& places = places_[static_cast<std::size_t>(row(b, l))];
      block.place.insert(block.place.end(), places.begin(), places.end());
    }
    std::sort(block.place.begin(), block.place.end());
    block.place.erase(std::unique(block.place.begin(), block.place.end()), block.place.end());
    block.values.resize(block.place.size());
    for (const std::uint16_t t : block.place) block.averages += is_average(t) ? 1 : 0;
    for (std::size_t l = 0; l < rows_at_once && row(b, l) >= 0; ++l)
      fill(block, l, static_cast<std::size_t>(row(b, l)));
    return block;
  }

  /// Of block b in place l; -1: none.
  [[nodiscard]] std::int32_t row(std::size_t b, std::size_t l) const noexcept {
    const std::size_t at = rows_at_once * b + l;
    return at < order_.size() ? order_[at] : -1;
  }
  [[nodiscard]] std::size_t count() const noexcept { return (order_.size() + rows_at_once - 1) / rows_at_once; }
  [[nodiscard]] const core::WaveletPicture& shape() const noexcept { return shape_; }
  [[nodiscard]] std::size_t tiles() const noexcept { return shape_.coefficients() / tile; }

 private:
  [[nodiscard]] bool is_average(std::size_t t) const noexcept { return t * tile < shape_.averages(); }

  void fill(Block& block, std::size_t l, std::size_t m) const {
    std::size_t at = 0;
    for (std::size_t own = 0; own < places_[m].size(); ++own) {
      while (block.place[at] < places_[m][own]) ++at;
      for (std::size_t k = 0; k < tile; ++k) {
        const double value = values_[m][own * tile + k];
        block.values[at][l * tile + k] = value;
        if (!is_average(places_[m][own])) block.largest[l] = std::max(block.largest[l], std::abs(value));
      }
    }
  }

  core::WaveletPicture shape_;
  std::vector<std::vector<std::uint16_t>> places_;  // of each row
  std::vector<std::vector<double>> values_;
  std::vector<std::int32_t> order_;
};

void push_bf16(const std::array<double, rows_at_once * tile>& rows, std::vector<std::uint32_t>& words) {
  for (std::size_t l = 0; l < rows_at_once; l += 2) {
    for (std::size_t k = 0; k < tile; ++k) {
      words.push_back(bf16_of(rows[l * tile + k]) | static_cast<std::uint32_t>(bf16_of(rows[(l + 1) * tile + k]))
                                                        << 16U);
    }
  }
}

void push_int8(const std::array<double, rows_at_once * tile>& rows, const std::array<float, rows_at_once>& scale,
               std::vector<std::uint32_t>& words) {
  for (std::size_t k = 0; k < tile; ++k) {
    std::uint32_t word = 0;
    for (std::size_t l = 0; l < rows_at_once; ++l) {
      const auto byte = static_cast<std::uint8_t>(int8_of(rows[l * tile + k], scale[l]));
      word |= static_cast<std::uint32_t>(byte) << (8U * l);
    }
    words.push_back(word);
  }
}

/// Bands of tiles with about as much work each: twelve where the picture is large, as many as two, three or four
/// workers can share evenly. `work` of each tile of the picture.
std::vector<std::uint32_t> bands_of(const std::vector<std::size_t>& work) {
  constexpr std::size_t many = 12;
  const std::size_t bands = work.size() * tile >= core::Crew::least_worth ? many : 1;
  std::size_t all = 0, sum = 0;
  for (const std::size_t each : work) all += each;
  std::vector<std::uint32_t> begins{0};
  for (std::size_t t = 0; t < work.size() && begins.size() < bands; ++t) {
    sum += work[t];
    if (sum * bands >= begins.size() * all) begins.push_back(static_cast<std::uint32_t>(t + 1));
  }
  while (begins.size() <= bands) begins.push_back(static_cast<std::uint32_t>(work.size()));
  return begins;
}

/// Where every block begins, refined by bands.
std::vector<std::uint32_t> banded(const std::vector<std::uint32_t>& block_first,
                                  const std::vector<std::uint16_t>& place, const std::vector<std::uint32_t>& band) {
  std::vector<std::uint32_t> first;
  for (std::size_t b = 0; b + 1 < block_first.size(); ++b) {
    std::uint32_t t = block_first[b];
    for (std::size_t k = 0; k + 1 < band.size(); ++k) {
      while (t < block_first[b + 1] && place[t] < band[k]) ++t;
      first.push_back(t);
    }
  }
  first.push_back(block_first.back());
  return first;
}

}  // namespace

template <class T>
WaveletRunTables<T> wavelet_run_tables(const Response& seeing) {
  WaveletRunTables<T> tables;
  const Blocks blocks(seeing);
  std::vector<std::uint32_t> averages{0}, details{0};
  std::vector<std::size_t> work(blocks.tiles(), 0);
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    const Block block = blocks.at(b);
    std::array<float, rows_at_once> scale{};
    for (std::size_t l = 0; l < rows_at_once; ++l) {
      scale[l] = int8_scale(block.largest[l]);
      tables.scale.push_back(static_cast<T>(scale[l]));
      tables.row.push_back(blocks.row(b, l));
    }
    for (std::size_t t = 0; t < block.place.size(); ++t) {
      ++work[block.place[t]];
      auto& list = t < block.averages ? tables.averages : tables.details;
      list.place.push_back(block.place[t]);
      if (t < block.averages) push_bf16(block.values[t], list.words);
      if (t >= block.averages) push_int8(block.values[t], scale, list.words);
    }
    averages.push_back(static_cast<std::uint32_t>(tables.averages.place.size()));
    details.push_back(static_cast<std::uint32_t>(tables.details.place.size()));
  }
  tables.band = bands_of(work);
  tables.averages.first = banded(averages, tables.averages.place, tables.band);
  tables.details.first = banded(details, tables.details.place, tables.band);
  const auto view = [](const auto& list) {
    return typename core::WaveletRuns<T>::Tiles{list.first.data(), list.place.data(), list.words.data()};
  };
  tables.view = {blocks.shape(),       blocks.count(),      tables.band.size() - 1, view(tables.averages),
                 view(tables.details), tables.scale.data(), tables.row.data(),      tables.band.data()};
  return tables;
}

template WaveletRunTables<float> wavelet_run_tables(const Response&);
template WaveletRunTables<double> wavelet_run_tables(const Response&);

}  // namespace compueye::recon
