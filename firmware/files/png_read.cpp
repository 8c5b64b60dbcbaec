#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/png.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::Result;

// libpng leaves its functions by longjmp, which runs no destructors: every call of it happens inside a step, a plain
// function without objects of its own, and what the steps share lives here.
class PngReader {
 public:
  explicit PngReader(const std::string& bytes) : bytes_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  /// Runs a step; false when libpng gave up, then message() says why.
  [[nodiscard]] bool run(void (*step)(PngReader&)) {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    step(*this);
    return true;
  }

  static void read_header(PngReader& r) {
    png_set_read_fn(r.png_, &r, get_bytes);
    // The picture's own limit is checked by the caller, with better words.
    png_set_user_limits(r.png_, 0x7FFFFFFF, 0x7FFFFFFF);
    png_set_chunk_malloc_max(r.png_, 8U << 20U);
    png_read_info(r.png_, r.info_);
    r.rows = png_get_image_height(r.png_, r.info_);
    r.cols = png_get_image_width(r.png_, r.info_);
    r.file_bits_a_pixel =
        static_cast<std::size_t>(png_get_bit_depth(r.png_, r.info_)) * png_get_channels(r.png_, r.info_);
  }

  static void prepare_rows(PngReader& r) {
    png_set_expand(r.png_);
    png_set_swap(r.png_);
    png_set_interlace_handling(r.png_);
    png_read_update_info(r.png_, r.info_);
    r.stride = png_get_rowbytes(r.png_, r.info_);
    r.channels = png_get_channels(r.png_, r.info_);
    r.wide = png_get_bit_depth(r.png_, r.info_) == 16;
  }

  static void read_rows(PngReader& r) {
    png_read_image(r.png_, r.row_pointers.data());
    png_read_end(r.png_, nullptr);
  }

  [[nodiscard]] std::string message() const { return message_[0] != '\0' ? message_ : "out of memory"; }

  std::size_t rows = 0, cols = 0, file_bits_a_pixel = 0;
  std::size_t stride = 0, channels = 0;
  bool wide = false;
  std::vector<png_byte> raster;
  std::vector<png_bytep> row_pointers;

 private:
  [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
    auto& self = *static_cast<PngReader*>(png_get_error_ptr(png));
    std::strncpy(self.message_, message, sizeof self.message_ - 1);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void get_bytes(png_structp png, png_bytep into, std::size_t count) {
    auto& self = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > self.bytes_.size() - self.at_) png_error(png, "it ends too early");
    std::memcpy(into, self.bytes_.data() + self.at_, count);
    self.at_ += count;
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  char message_[96] = {};
};

tl::unexpected<hal::Error> damaged(const std::string& path, const PngReader& reader) {
  return hal::fail(ErrorCode::bad_format, path, "is a damaged PNG (" + reader.message() + "), expected a whole one");
}

Result<void> check_size(const std::string& path, const PngReader& reader, std::size_t file_bytes) {
  const std::string size = std::to_string(reader.rows) + " x " + std::to_string(reader.cols);
  if (reader.rows > max_png_side || reader.cols > max_png_side) {
    return hal::fail(ErrorCode::out_of_range, path,
                     "has " + size + " pixels, expected at most " + std::to_string(max_png_side) + " rows and columns");
  }
  // Deflate shrinks by 1032 at most: a tiny file cannot make us take a lot of memory.
  const std::size_t raw = reader.rows * ((reader.cols * reader.file_bits_a_pixel + 7) / 8);
  if (raw / 1032 > file_bytes) {
    return hal::fail(ErrorCode::bad_format, path,
                     "claims " + size + " pixels, which its " + std::to_string(file_bytes) + " bytes cannot hold");
  }
  return {};
}

template <class Code>
struct Raster {
  const PngReader& reader;
  [[nodiscard]] double code(std::size_t row, std::size_t col, std::size_t channel) const {
    Code value;
    std::memcpy(&value, reader.raster.data() + row * reader.stride + (col * reader.channels + channel) * sizeof(Code),
                sizeof value);
    return value;
  }
};

template <class Code>
Result<void> check_opaque(const std::string& path, const PngReader& reader) {
  const Raster<Code> raster{reader};
  if (reader.channels == 1 || reader.channels == 3) return {};
  for (std::size_t row = 0; row < reader.rows; ++row) {
    for (std::size_t col = 0; col < reader.cols; ++col) {
      if (raster.code(row, col, reader.channels - 1) == std::numeric_limits<Code>::max()) continue;
      return hal::fail(ErrorCode::unsupported, path,
                       "is not opaque at row " + std::to_string(row) + ", column " + std::to_string(col) +
                           ", expected a picture without transparency: flatten it onto its background first");
    }
  }
  return {};
}

template <class Code>
hal::Image to_grey(const PngReader& reader) {
  constexpr double white = std::numeric_limits<Code>::max();
  const Raster<Code> raster{reader};
  const bool colour = reader.channels >= 3;
  hal::Image image(static_cast<int>(reader.rows), static_cast<int>(reader.cols));
  std::size_t at = 0;
  for (std::size_t row = 0; row < reader.rows; ++row) {
    for (std::size_t col = 0; col < reader.cols; ++col, ++at) {
      const double first = raster.code(row, col, 0);
      double grey = first;
      if (colour) {
        const double second = raster.code(row, col, 1), third = raster.code(row, col, 2);
        // Grey stored as colour keeps its code exactly.
        if (second != first || third != first) grey = 0.2126 * first + 0.7152 * second + 0.0722 * third;
      }
      image.pixels[at] = static_cast<float>(grey / white);
    }
  }
  return image;
}

template <class Code>
std::vector<hal::Image> to_bands(const PngReader& reader) {
  constexpr double white = std::numeric_limits<Code>::max();
  const Raster<Code> raster{reader};
  std::vector<hal::Image> bands(reader.channels >= 3 ? 3 : 1,
                                hal::Image(static_cast<int>(reader.rows), static_cast<int>(reader.cols)));
  for (std::size_t band = 0; band < bands.size(); ++band) {
    std::size_t at = 0;
    for (std::size_t row = 0; row < reader.rows; ++row) {
      for (std::size_t col = 0; col < reader.cols; ++col, ++at) {
        bands[band].pixels[at] = static_cast<float>(raster.code(row, col, band) / white);
      }
    }
  }
  const bool grey =
      bands.front().pixels == bands.back().pixels && bands.front().pixels == bands[bands.size() / 2].pixels;
  if (grey) bands.resize(1);
  return bands;
}

/// Pictures that people have and that are no PNG, by how their files begin.
struct OtherKind {
  std::string_view begin;
  std::string_view name;
};
constexpr std::array<OtherKind, 6> other_kinds{
    {{"\xFF\xD8\xFF", "JPEG"}, {"GIF8", "GIF"}, {"BM", "BMP"}, {"RIFF", "WebP"}, {"II*", "TIFF"}, {"MM", "TIFF"}}};

Result<void> accept_png(const std::string& path, std::string_view begin) {
  if (begin.size() >= 8 && png_sig_cmp(reinterpret_cast<png_const_bytep>(begin.data()), 0, 8) == 0) return {};
  if (begin.empty()) return hal::fail(ErrorCode::bad_format, path, "is an empty file, expected a PNG picture");
  const auto* kind = std::find_if(other_kinds.begin(), other_kinds.end(),
                                  [&](const OtherKind& each) { return begin.starts_with(each.begin); });
  if (kind == other_kinds.end()) return hal::fail(ErrorCode::bad_format, path, "is not a PNG picture");
  return hal::fail(
      ErrorCode::unsupported, path,
      "is a " + std::string(kind->name) +
          " picture, expected a PNG: convert it first, as ImageMagick's 'convert photo.jpg photo.png' does");
}

/// What the function for the depth of the file, of 8 or 16 bits, makes of the picture.
template <class Made>
Result<Made> made_of(const std::string& path, Made (*of_8)(const PngReader&), Made (*of_16)(const PngReader&)) {
  // Incompressible RGBA of 16 bits at the largest size, with room for other chunks.
  constexpr std::uint64_t max_file_bytes = std::uint64_t{1} << 30U;
  const std::string bytes =
      TRY(read_whole_file(path, max_file_bytes, [&](std::string_view begin) { return accept_png(path, begin); }));
  PngReader reader(bytes);
  if (!reader.run(PngReader::read_header)) return damaged(path, reader);
  TRY(check_size(path, reader, bytes.size()));
  if (!reader.run(PngReader::prepare_rows)) return damaged(path, reader);
  reader.raster.resize(reader.rows * reader.stride);
  reader.row_pointers.resize(reader.rows);
  for (std::size_t row = 0; row < reader.rows; ++row) {
    reader.row_pointers[row] = reader.raster.data() + row * reader.stride;
  }
  if (!reader.run(PngReader::read_rows)) return damaged(path, reader);
  TRY(reader.wide ? check_opaque<std::uint16_t>(path, reader) : check_opaque<std::uint8_t>(path, reader));
  return reader.wide ? of_16(reader) : of_8(reader);
}

}  // namespace

Result<hal::Image> read_png(const std::string& path) {
  return made_of(path, to_grey<std::uint8_t>, to_grey<std::uint16_t>);
}

Result<std::vector<hal::Image>> read_png_bands(const std::string& path) {
  return made_of(path, to_bands<std::uint8_t>, to_bands<std::uint16_t>);
}

}  // namespace compueye::firmware
