#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/result.hpp"

namespace compueye::firmware {

enum class PngFormat : std::uint8_t { grey8, grey16, rgb8 };

/// Encodes pictures of one size and format as PNG. All memory, libpng's and zlib's included, is taken in create();
/// encode() does not allocate.
class PngEncoder {
 public:
  /// Errors: usage (a side below 1 or above max_png_side).
  [[nodiscard]] static hal::Result<PngEncoder> create(int rows, int cols, PngFormat format);

  /// Where the rows of the picture go before encode(), without padding: grey8 one byte a pixel, rgb8 three, grey16
  /// two with the low byte first.
  [[nodiscard]] std::span<std::byte> raster() noexcept { return raster_; }

  /// Fills the raster from linear intensities: clipped to 0..1, NaN as 0. Grey formats only; rows * cols pixels.
  void set_grey(std::span<const float> pixels) noexcept;

  /// The PNG of the raster, valid until the next call. Error io when libpng fails, which it has no reason to.
  [[nodiscard]] hal::Result<std::span<const std::byte>> encode();

 private:
  PngEncoder() = default;
  int rows_ = 0;
  int cols_ = 0;
  PngFormat format_ = PngFormat::grey8;
  std::vector<std::byte> raster_;
  std::vector<std::byte> arena_;
  std::vector<std::byte> output_;
};

}  // namespace compueye::firmware
