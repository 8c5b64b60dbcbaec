#include "firmware/sinks/frame_list_sink.hpp"

#include <unistd.h>

#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

#include "firmware/files/atomic_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {

FrameListSink::~FrameListSink() {
  static_cast<void>(FrameListSink::close());
}

hal::Result<void> FrameListSink::open(hal::FrameFormat /*format*/) {
  if (file_) return hal::fail(hal::ErrorCode::usage, path_, "is already open, expected a close() first");
  TRY(make_folder(std::filesystem::path(path_).parent_path()));
  if (made_) ::unlink(path_.c_str());
  GrowingFile file = TRY(GrowingFile::create(path_));
  made_ = true;
  TRY(file.append(std::as_bytes(std::span(std::string_view("frame,t_ns\n")))));
  file_.emplace(std::move(file));
  return {};
}

hal::Result<void> FrameListSink::write(const hal::Frame& frame) {
  if (!file_) return hal::fail(hal::ErrorCode::usage, path_, "is not open, expected an open() first");
  char line[64];
  const int length = std::snprintf(line, sizeof line, "%" PRIu64 ",%" PRId64 "\n", frame.frame, frame.t_ns);
  return file_->append(std::as_bytes(std::span(line, static_cast<std::size_t>(length))));
}

hal::Result<void> FrameListSink::close() {
  if (!file_) return {};
  GrowingFile file = std::move(*file_);
  file_.reset();
  return file.close();
}

}  // namespace compueye::firmware
