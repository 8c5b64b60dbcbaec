#include "firmware/sinks/npy_sink.hpp"

#include <filesystem>
#include <span>

#include "firmware/files/npy_header.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

NpySink::~NpySink() {
  static_cast<void>(NpySink::close());
}

// Wide enough for any number of frames, so that it can be written again in place.
std::string NpySink::header() const {
  const std::int64_t shape[] = {frames_, format_.rows, format_.cols};
  return format_npy_header("<f4", shape, 128);
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
  AtomicFile file = TRY(AtomicFile::create(path_));
  format_ = format;
  frames_ = 0;
  torn_ = false;
  const std::string top = header();
  TRY(file.write(top));
  // A device or pipe would only fail at close(), after all the work.
  TRY(file.overwrite(0, std::as_bytes(std::span(top))));
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
  if (torn_) {
    return hal::fail(hal::ErrorCode::io, path_, "already failed to take a picture; close it to keep the rest");
  }
  auto ok = file_->write(std::as_bytes(frame.pixels));
  torn_ = !ok;
  if (ok) ++frames_;
  return ok;
}

hal::Result<void> NpySink::close() {
  if (!file_) return {};
  AtomicFile file = std::move(*file_);
  file_.reset();
  const std::string top = header();
  if (torn_) TRY(file.truncate(top.size() + static_cast<std::uint64_t>(frames_) * pixels() * sizeof(float)));
  TRY(file.overwrite(0, std::as_bytes(std::span(top))));
  return file.commit();
}

}  // namespace compueye::firmware
