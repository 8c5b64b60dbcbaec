#include "firmware/sinks/npy_sink.hpp"

#include <filesystem>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

NpySink::~NpySink() {
  static_cast<void>(NpySink::close());
}

hal::Result<void> NpySink::open(hal::FrameFormat format) {
  if (writer_) return hal::fail(hal::ErrorCode::usage, path_, "is already open, expected a close() first");
  TRY(make_folder(std::filesystem::path(path_).parent_path()));
  writer_.emplace(TRY(NpyFrameWriter::create(path_, format.rows, format.cols)));
  return {};
}

hal::Result<void> NpySink::write(const hal::Frame& frame) {
  if (!writer_) return hal::fail(hal::ErrorCode::usage, path_, "is not open, expected an open() first");
  return writer_->write(frame.pixels);
}

hal::Result<void> NpySink::close() {
  if (!writer_) return {};
  NpyFrameWriter writer = std::move(*writer_);
  writer_.reset();
  return writer.close();
}

}  // namespace compueye::firmware
