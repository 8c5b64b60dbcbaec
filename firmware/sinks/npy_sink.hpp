#pragma once

#include <optional>
#include <string>
#include <utility>

#include "firmware/files/npy_frame_writer.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// Streams frames into one .npy file of shape (frames, rows, cols), float32, values as they come. The file appears
/// under its name with close(), or when the sink goes away; write() does not allocate.
class NpySink final : public hal::FrameSink {
 public:
  /// The folder of `file` is made when it is missing.
  explicit NpySink(std::string file) : path_(std::move(file)) {}
  NpySink(const NpySink&) = delete;
  NpySink& operator=(const NpySink&) = delete;
  ~NpySink() override;

  /// Errors: usage (already open), those of NpyFrameWriter::create().
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  [[nodiscard]] hal::Result<void> close() override;

 private:
  std::string path_;
  std::optional<NpyFrameWriter> writer_;
};

}  // namespace compueye::firmware
