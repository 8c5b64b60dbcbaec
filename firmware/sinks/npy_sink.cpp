#include "firmware/sinks/npy_sink.hpp"

#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <span>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/npy_header.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

NpySink::~NpySink() {
  static_cast<void>(NpySink::close());
}

std::size_t NpySink::pixels() const noexcept {
  return static_cast<std::size_t>(format_.rows) * static_cast<std::size_t>(format_.cols);
}

hal::Result<void> NpySink::open(hal::FrameFormat format) {
  if (file_) return hal::fail(hal::ErrorCode::usage, path_, "is already open, expected a close() first");
  TRY(make_folder(std::filesystem::path(path_).parent_path()));
  if (format.rows < 1 || format.cols < 1) {
    return hal::fail(hal::ErrorCode::usage, path_,
                     "was to hold pictures of " + std::to_string(format.rows) + " x " + std::to_string(format.cols) +
                         " pixels, expected at least 1 x 1");
  }
  if (made_) ::unlink(path_.c_str());
  GrowingFile file = TRY(GrowingFile::create(path_));
  made_ = true;
  format_ = format;
  frames_ = 0;
  // Wide enough for any number of frames, so that it can be written again in place.
  const std::int64_t shape[] = {frames_, format_.rows, format_.cols};
  header_ = format_npy_header("<f4", shape, 128);
  shape_at_ = header_.find('(') + 1;
  TRY(file.append(std::as_bytes(std::span(header_))));
  file_.emplace(std::move(file));
  return {};
}

hal::Result<void> NpySink::write(const hal::Frame& frame) {
  if (!file_) return hal::fail(hal::ErrorCode::usage, path_, "is not open, expected an open() first");
  if (frame.pixels.size() != pixels()) {
    return hal::fail(hal::ErrorCode::usage, path_,
                     "was given a picture of " + std::to_string(frame.pixels.size()) + " pixels, expected " +
                         std::to_string(pixels()));
  }
  TRY(file_->append(std::as_bytes(frame.pixels)));
  ++frames_;
  // After the picture: a header that tells of less than there is can be read.
  const std::span<char> shape = std::span(header_).subspan(shape_at_, header_.size() - 1 - shape_at_);
  const int used =
      std::snprintf(shape.data(), shape.size(), "%" PRId64 ", %d, %d), }", frames_, format_.rows, format_.cols);
  std::fill(shape.begin() + used, shape.end(), ' ');
  return file_->overwrite(shape_at_, std::as_bytes(shape));
}

hal::Result<void> NpySink::close() {
  if (!file_) return {};
  GrowingFile file = std::move(*file_);
  file_.reset();
  return file.close();
}

}  // namespace compueye::firmware
