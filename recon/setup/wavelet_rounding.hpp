#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "recon/core/operators/wavelet_picture.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// Rows of A as core::WaveletRuns hold them: coefficients of core::WaveletPicture, averages rounded to bfloat16,
/// details to whole numbers -127 .. 127 times a scale of their row, and no tile that is negligible beside its row.
class WaveletRows {
 public:
  /// Of a response that knows its picture, of at least least_wavelet_side pixels a side.
  explicit WaveletRows(const Response& response);

  /// Row m, rounded. Rounding what rounding left changes nothing.
  void round(int m);
  /// Row m of a response that consists of rounded rows: the numbers that it was made of, exactly.
  void recover(int m);

  /// Of the last row: those of averages first (shape().averages() of them), tile after tile.
  [[nodiscard]] const std::vector<double>& coefficients() const noexcept { return coefficients_; }
  /// The tiles of the last row that are not nought.
  [[nodiscard]] const std::vector<std::size_t>& tiles() const noexcept { return tiles_; }
  /// The row that these coefficients are, as a picture.
  [[nodiscard]] const std::vector<double>& picture();
  [[nodiscard]] const core::WaveletPicture& shape() const noexcept { return shape_; }

 private:
  void analyse(int m);
  void round_averages();
  void round_details();
  [[nodiscard]] bool drop_negligible(double least);
  [[nodiscard]] double energy_of_bright() const;
  [[nodiscard]] double largest_of(bool details) const;
  [[nodiscard]] bool is_detail(std::size_t t) const noexcept {
    return t * core::WaveletPicture::tile >= shape_.averages();
  }

  const Response& response_;
  core::WaveletPicture shape_;
  std::vector<double> picture_, exact_, coefficients_, scratch_;
  std::vector<std::size_t> tiles_;  // with something in them, ascending
};

inline constexpr int least_wavelet_side = 16;
/// Whether the picture is known, long enough on both sides, and 16 bits can number its tiles.
[[nodiscard]] bool wavelets_fit(const Response& response) noexcept;

/// The matrix of rounded rows.
[[nodiscard]] Response rounded_in_wavelets(const Response& response);

/// The largest ||a - rounded a|| / ||a|| over the rows.
[[nodiscard]] double worst_row_error(const Response& response, const Response& rounded);

/// A tile of sixteen coefficients whose norm is below this share of its row's is left out. On rows of the 80x80 eye as
/// a calibration finds them that makes errors of .36 % (the worst row .55 %): less than a calibration of 1024 captures
/// leaves (.48 %), and a twentieth of the noise of a sample. .0005 takes a fourth more tiles for .30 %, .001 a fifth
/// fewer for .45 %.
inline constexpr double negligible_tile = 0.0007;

/// Rows farther off than this are not smooth enough to be held so: what a calibration of 256 captures leaves (.78 %).
inline constexpr double most_row_error = 0.008;

}  // namespace compueye::recon
