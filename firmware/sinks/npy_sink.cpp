#include "firmware/sinks/npy_sink.hpp"

#include <system_error>
#include <utility>

#include "firmware/files/file_error.hpp"

namespace compueye::firmware {

NpySink::~NpySink() {
  static_cast<void>(NpySink::close());
}

hal::Result<void> NpySink::open(hal::FrameFormat format) {
  if (writer_) return hal::fail(hal::ErrorCode::usage, path_.string(), "is already open, expected a close() first");
  std::error_code ec;
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), ec);
  if (ec) return tl::unexpected(file_error(ec.value(), path_.parent_path(), "cannot be made"));
  auto writer = NpyFrameWriter::create(path_, format.rows, format.cols);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  writer_.emplace(std::move(*writer));
  return {};
}

hal::Result<void> NpySink::write(const hal::Frame& frame) {
  if (!writer_) return hal::fail(hal::ErrorCode::usage, path_.string(), "is not open, expected an open() first");
  return writer_->write(frame.pixels);
}

hal::Result<void> NpySink::close() {
  if (!writer_) return {};
  NpyFrameWriter writer = std::move(*writer_);
  writer_.reset();
  return writer.close();
}

}  // namespace compueye::firmware
