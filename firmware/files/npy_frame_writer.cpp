#include "firmware/files/npy_frame_writer.hpp"

#include <string>
#include <utility>

#include "firmware/files/npy_header.hpp"

namespace compueye::firmware {
namespace {

// Wide enough for any frame count, so that the header can be rewritten in place.
constexpr std::size_t header_bytes = 128;

std::string header_for(std::int64_t frames, int rows, int cols) {
  const std::int64_t shape[] = {frames, rows, cols};
  return format_npy_header(NpyType::f4, shape, header_bytes);
}

}  // namespace

hal::Result<NpyFrameWriter> NpyFrameWriter::create(const std::filesystem::path& path, int rows, int cols) {
  if (rows < 1 || cols < 1) {
    return hal::fail(hal::ErrorCode::usage, path.string(),
                     "was to hold pictures of " + std::to_string(rows) + " x " + std::to_string(cols) +
                         " pixels, expected at least 1 x 1");
  }
  auto file = AtomicFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  // A device or pipe would only fail at close(), after all the work.
  const std::string header = header_for(0, rows, cols);
  auto begun = file->write(header).and_then([&] { return file->overwrite(0, std::as_bytes(std::span(header))); });
  if (!begun) return tl::unexpected(std::move(begun.error()));
  NpyFrameWriter writer(std::move(*file));
  writer.path_ = path;
  writer.rows_ = rows;
  writer.cols_ = cols;
  return writer;
}

hal::Result<void> NpyFrameWriter::write(std::span<const float> pixels) {
  const std::size_t expected = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_);
  if (!file_ || pixels.size() != expected) {
    return hal::fail(hal::ErrorCode::usage, path_.string(),
                     file_ ? "was given a picture of " + std::to_string(pixels.size()) + " pixels, expected " +
                                 std::to_string(expected)
                           : std::string("is closed, expected no further picture"));
  }
  if (torn_) {
    return hal::fail(hal::ErrorCode::io, path_.string(), "already failed to take a picture; close it to keep the rest");
  }
  auto ok = file_->write(std::as_bytes(pixels));
  torn_ = !ok;
  if (ok) ++frames_;
  return ok;
}

hal::Result<void> NpyFrameWriter::close() {
  if (!file_) return {};
  AtomicFile file = std::move(*file_);
  file_.reset();
  const std::string header = header_for(frames_, rows_, cols_);
  const std::uint64_t frame_bytes =
      static_cast<std::uint64_t>(rows_) * static_cast<std::uint64_t>(cols_) * sizeof(float);
  hal::Result<void> whole;
  if (torn_) whole = file.truncate(header.size() + static_cast<std::uint64_t>(frames_) * frame_bytes);
  return whole.and_then([&] { return file.overwrite(0, std::as_bytes(std::span(header))); }).and_then([&] {
    return file.commit();
  });
}

}  // namespace compueye::firmware
