#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Pictures of at most this many rows and columns are read and written.
inline constexpr int max_png_side = 8192;

/// Reads a PNG of any kind (grey, grey with alpha, palette, RGB, RGBA; 1 to 16 bits; interlaced or not) as a grey
/// picture. A code is taken as a linear intensity, code / (2^bits - 1): scenes are given in linear units, so gamma,
/// sRGB and ICC chunks are left aside. Colours become 0.2126 R + 0.7152 G + 0.0722 B (ITU-R BT.709 luminance).
/// Errors: not_found, io; bad_format (no PNG, truncated, damaged, a size that the file is too small for), unsupported
/// (pixels that are not opaque, because what is behind them is not known), out_of_range (more than max_png_side).
[[nodiscard]] hal::Result<hal::Image> read_png(const std::string& path);

/// The same as its bands: red, green and blue, or one where every pixel is grey.
[[nodiscard]] hal::Result<std::vector<hal::Image>> read_png_bands(const std::string& path);

/// Writes a grey PNG of 8 or 16 bits atomically: code = round(value * (2^bits - 1)), values clipped to 0..1, NaN as 0.
/// Errors: usage (bits, size), those of AtomicFile.
[[nodiscard]] hal::Result<void> write_png(const std::string& path, const hal::Image& image, int bits = 8);

/// An RGB picture with 8 bits a channel: rows * cols * 3 bytes, row 0 on top.
struct RgbImage {
  int rows = 0;
  int cols = 0;
  std::vector<std::uint8_t> pixels;
};
[[nodiscard]] hal::Result<void> write_png(const std::string& path, const RgbImage& image);

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
