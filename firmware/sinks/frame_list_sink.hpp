#pragma once

#include <optional>
#include <string>
#include <utility>

#include "firmware/files/growing_file.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// A table of the frames that were kept, in their order: "frame,t_ns" and a line each, the frame's own number and the
/// start of its exposure. A line is in the file as soon as it is written; write() does not allocate.
class FrameListSink final : public hal::FrameSink {
 public:
  explicit FrameListSink(std::string file) : path_(std::move(file)) {}
  FrameListSink(const FrameListSink&) = delete;
  FrameListSink& operator=(const FrameListSink&) = delete;
  ~FrameListSink() override;

  /// The folder is made when it is missing; a table that this sink wrote before is replaced. Errors: usage (already
  /// open), those of GrowingFile.
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  [[nodiscard]] hal::Result<void> close() override;

 private:
  std::string path_;
  std::optional<GrowingFile> file_;
  bool made_ = false;
};

}  // namespace compueye::firmware
