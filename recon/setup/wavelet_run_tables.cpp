#include "recon/setup/wavelet_run_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "recon/core/parts/crew.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/wavelet_rounding.hpp"

namespace compueye::recon {
namespace {

constexpr std::size_t tile = core::WaveletPicture::tile;
constexpr std::size_t rows_at_once = core::WaveletRuns<float>::rows_at_once;

/// The tiles of four rows, and of a fourth each what it is in all of them.
struct Block {
  std::vector<std::uint16_t> place;                             ///< ascending
  std::vector<std::array<double, rows_at_once * tile>> values;  ///< row after row
  std::size_t averages = 0;                                     ///< how many of the tiles are of averages
  std::array<double, rows_at_once> largest{};                   ///< detail of each row
};

class Blocks {
 public:
  explicit Blocks(const Response& seeing) : seeing_(seeing), rows_(seeing) {}

  [[nodiscard]] Block at(std::size_t b) {
    Block block;
    std::array<std::vector<double>, rows_at_once> of_row;
    std::vector<bool> seen(tiles(), false);
    for (std::size_t l = 0; l < rows_at_once && exists(b, l); ++l) {
      rows_.recover(static_cast<int>(rows_at_once * b + l));
      of_row[l] = rows_.coefficients();
      for (const std::size_t t : rows_.tiles()) {
        seen[t] = true;
        for (std::size_t k = t * tile; k < (t + 1) * tile && !is_average(t); ++k) {
          block.largest[l] = std::max(block.largest[l], std::abs(of_row[l][k]));
        }
      }
    }
    for (std::size_t t = 0; t < tiles(); ++t) {
      if (!seen[t]) continue;
      block.place.push_back(static_cast<std::uint16_t>(t));
      block.averages += is_average(t) ? 1 : 0;
      auto& values = block.values.emplace_back();
      for (std::size_t l = 0; l < rows_at_once && exists(b, l); ++l) {
        std::copy_n(of_row[l].begin() + static_cast<std::ptrdiff_t>(t * tile), tile,
                    values.begin() + static_cast<std::ptrdiff_t>(l * tile));
      }
    }
    return block;
  }

  [[nodiscard]] bool exists(std::size_t b, std::size_t l) const noexcept {
    return rows_at_once * b + l < static_cast<std::size_t>(seeing_.rows());
  }
  [[nodiscard]] std::size_t count() const noexcept {
    return (static_cast<std::size_t>(seeing_.rows()) + rows_at_once - 1) / rows_at_once;
  }
  [[nodiscard]] const core::WaveletPicture& shape() const noexcept { return rows_.shape(); }
  [[nodiscard]] bool is_average(std::size_t t) const noexcept { return t * tile < shape().averages(); }
  [[nodiscard]] std::size_t tiles() const noexcept { return shape().coefficients() / tile; }

 private:
  const Response& seeing_;
  WaveletRows rows_;
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
  Blocks blocks(seeing);
  std::vector<std::uint32_t> averages{0}, details{0};
  std::vector<std::size_t> work(blocks.tiles(), 0);
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    const Block block = blocks.at(b);
    std::array<float, rows_at_once> scale{};
    for (std::size_t l = 0; l < rows_at_once; ++l) {
      scale[l] = int8_scale(block.largest[l]);
      tables.scale.push_back(static_cast<T>(scale[l]));
      tables.row.push_back(blocks.exists(b, l) ? static_cast<std::int32_t>(rows_at_once * b + l) : -1);
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
