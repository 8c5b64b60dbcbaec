#include <cstring>
#include <string>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/png.hpp"
#include "firmware/files/png_encoder.hpp"

namespace compueye::firmware {
namespace {

hal::Result<void> refuse(const std::filesystem::path& path, const std::string& sentence) {
  return hal::fail(hal::ErrorCode::usage, path.string(), sentence);
}

bool holds(std::size_t values, int rows, int cols, std::size_t channels) {
  return rows >= 0 && cols >= 0 && values == static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols) * channels;
}

hal::Result<void> write_encoded(const std::filesystem::path& path, PngEncoder& encoder) {
  auto bytes = encoder.encode();
  if (!bytes) {
    bytes.error().place = path.string();
    return tl::unexpected(std::move(bytes.error()));
  }
  return write_file_atomically(path, *bytes);
}

}  // namespace

hal::Result<void> write_png(const std::filesystem::path& path, const hal::Image& image, int bits) {
  if (bits != 8 && bits != 16) return refuse(path, "was to have " + std::to_string(bits) + " bits, expected 8 or 16");
  if (!holds(image.pixels.size(), image.rows, image.cols, 1))
    return refuse(path, "was given pixels that are not its size");
  auto encoder = PngEncoder::create(image.rows, image.cols, bits == 8 ? PngFormat::grey8 : PngFormat::grey16);
  if (!encoder) return refuse(path, encoder.error().sentence);
  encoder->set_grey(image.pixels);
  return write_encoded(path, *encoder);
}

hal::Result<void> write_png(const std::filesystem::path& path, const RgbImage& image) {
  if (!holds(image.pixels.size(), image.rows, image.cols, 3))
    return refuse(path, "was given pixels that are not its size");
  auto encoder = PngEncoder::create(image.rows, image.cols, PngFormat::rgb8);
  if (!encoder) return refuse(path, encoder.error().sentence);
  std::memcpy(encoder->raster().data(), image.pixels.data(), image.pixels.size());
  return write_encoded(path, *encoder);
}

}  // namespace compueye::firmware
