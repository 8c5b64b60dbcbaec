#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "firmware/files/png.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

std::size_t pixel_bytes(PngFormat format) {
  if (format == PngFormat::rgb8) return 3;
  return format == PngFormat::grey16 ? 2 : 1;
}

// What libpng's callbacks work on. Only trivial members: longjmp runs no destructors.
struct Job {
  int rows, cols;
  PngFormat format;
  std::span<std::byte> raster;
  std::span<std::byte> arena;
  std::size_t arena_used;
  std::span<std::byte> output;
  std::size_t output_used;
  char message[80];
};

// Freed memory is not reused within a picture; the arena starts anew with the next one.
png_voidp take_memory(png_structp png, png_alloc_size_t bytes) {
  auto& job = *static_cast<Job*>(png_get_mem_ptr(png));
  const std::size_t rounded = (bytes + 63) / 64 * 64;
  if (rounded < bytes || rounded > job.arena.size() - job.arena_used) return nullptr;
  std::byte* at = job.arena.data() + job.arena_used;
  job.arena_used += rounded;
  return at;
}

void give_memory(png_structp, png_voidp) {}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto& job = *static_cast<Job*>(png_get_error_ptr(png));
  std::strncpy(job.message, message, sizeof job.message - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void put_bytes(png_structp png, png_bytep bytes, std::size_t count) {
  auto& job = *static_cast<Job*>(png_get_io_ptr(png));
  if (count > job.output.size() - job.output_used) png_error(png, "the output buffer is too small");
  std::memcpy(job.output.data() + job.output_used, bytes, count);
  job.output_used += count;
}

void flush_nothing(png_structp) {}

void write_picture(png_structp png, png_infop info, Job& job) {
  png_set_write_fn(png, &job, put_bytes, flush_nothing);
  png_set_IHDR(png, info, static_cast<png_uint_32>(job.cols), static_cast<png_uint_32>(job.rows),
               job.format == PngFormat::grey16 ? 16 : 8,
               job.format == PngFormat::rgb8 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (job.format == PngFormat::grey16) png_set_swap(png);
  const std::size_t stride = static_cast<std::size_t>(job.cols) * pixel_bytes(job.format);
  for (std::size_t row = 0; row < static_cast<std::size_t>(job.rows); ++row) {
    png_write_row(png, reinterpret_cast<png_const_bytep>(job.raster.data() + row * stride));
  }
  png_write_end(png, nullptr);
}

bool run(Job& job) {
  png_structp png =
      png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning, &job, take_memory, give_memory);
  if (png == nullptr) return false;
  png_infop info = png_create_info_struct(png);
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  write_picture(png, info, job);
  png_destroy_write_struct(&png, &info);
  return true;
}

template <class Pixels, class Fill>
hal::Result<void> write_filled(const std::string& path, const Pixels& image, PngFormat format, Fill fill) {
  const std::size_t channels = format == PngFormat::rgb8 ? 3 : 1;
  if (image.rows < 0 || image.cols < 0 ||
      image.pixels.size() != static_cast<std::size_t>(image.rows) * static_cast<std::size_t>(image.cols) * channels) {
    return hal::fail(hal::ErrorCode::usage, path, "was given pixels that are not its size");
  }
  PngEncoder encoder = TRY(placed(PngEncoder::create(image.rows, image.cols, format), path));
  fill(encoder);
  return write_file_atomically(path, TRY(placed(encoder.encode(), path)));
}

}  // namespace

hal::Result<PngEncoder> PngEncoder::create(int rows, int cols, PngFormat format) {
  if (rows < 1 || cols < 1 || rows > max_png_side || cols > max_png_side) {
    return hal::fail(hal::ErrorCode::usage, "picture",
                     "has " + std::to_string(rows) + " x " + std::to_string(cols) + " pixels, expected 1 to " +
                         std::to_string(max_png_side) + " rows and columns");
  }
  PngEncoder encoder;
  encoder.rows_ = rows;
  encoder.cols_ = cols;
  encoder.format_ = format;
  const std::size_t stride = static_cast<std::size_t>(cols) * pixel_bytes(format);
  const std::size_t raw = (stride + 1) * static_cast<std::size_t>(rows);
  encoder.raster_.resize(stride * static_cast<std::size_t>(rows));
  // zlib takes 268 KB and libpng up to five rows; incompressible rows grow by less than 1/512 plus chunk headers.
  encoder.arena_.resize((512U << 10U) + 8 * stride);
  encoder.output_.resize(raw + raw / 256 + (64U << 10U));
  return encoder;
}

void PngEncoder::set_grey(std::span<const float> pixels) noexcept {
  const bool wide = format_ == PngFormat::grey16;
  const float white = wide ? 65535.0F : 255.0F;
  const std::size_t count = std::min(pixels.size(), raster_.size() / pixel_bytes(format_));
  for (std::size_t i = 0; i < count; ++i) {
    const float value = std::isnan(pixels[i]) ? 0.0F : std::clamp(pixels[i], 0.0F, 1.0F);
    const auto code = static_cast<std::uint16_t>(std::lround(value * white));
    if (wide) {
      raster_[2 * i] = static_cast<std::byte>(code & 0xFFU);
      raster_[2 * i + 1] = static_cast<std::byte>(code >> 8U);
    } else {
      raster_[i] = static_cast<std::byte>(code);
    }
  }
}

hal::Result<std::span<const std::byte>> PngEncoder::encode() {
  // libpng aligns nothing itself: start the arena on a boundary.
  void* base = arena_.data();
  std::size_t space = arena_.size();
  std::align(64, 1, base, space);
  Job job{rows_, cols_, format_, raster_, {static_cast<std::byte*>(base), space}, 0, output_, 0, {}};
  if (!run(job)) {
    return hal::fail(hal::ErrorCode::io, "picture", "cannot be encoded as PNG: " + std::string(job.message));
  }
  return std::span<const std::byte>(output_).first(job.output_used);
}

hal::Result<void> write_png(const std::string& path, const hal::Image& image, int bits) {
  if (bits != 8 && bits != 16) {
    return hal::fail(hal::ErrorCode::usage, path, "was to have " + std::to_string(bits) + " bits, expected 8 or 16");
  }
  return write_filled(path, image, bits == 8 ? PngFormat::grey8 : PngFormat::grey16,
                      [&](PngEncoder& encoder) { encoder.set_grey(image.pixels); });
}

hal::Result<void> write_png(const std::string& path, const RgbImage& image) {
  return write_filled(path, image, PngFormat::rgb8, [&](PngEncoder& encoder) {
    std::memcpy(encoder.raster().data(), image.pixels.data(), image.pixels.size());
  });
}

}  // namespace compueye::firmware
