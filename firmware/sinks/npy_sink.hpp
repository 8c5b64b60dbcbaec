#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// Streams frames into one .npy file of shape (frames, rows, cols), float32, values as they come, while their number is
/// still unknown.
///
/// The file has its name only after close(), which the destructor calls, and is then whole; until then, and after a
/// crash, it is a *.partial file. When the disk fills up, write() fails, and close() still delivers the frames that
/// were written whole. write() does not allocate.
class NpySink final : public hal::FrameSink {
 public:
  /// The folder of `file` is made when it is missing.
  explicit NpySink(std::string file) : path_(std::move(file)) {}
  NpySink(const NpySink&) = delete;
  NpySink& operator=(const NpySink&) = delete;
  ~NpySink() override;

  /// Errors: usage (rows or cols < 1, already open), those of AtomicFile, unsupported for a device or pipe.
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  /// Errors: usage (not rows * cols pixels, or not open), those of AtomicFile::write().
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  [[nodiscard]] hal::Result<void> close() override;

 private:
  [[nodiscard]] std::string header() const;
  [[nodiscard]] std::size_t pixels() const noexcept;

  std::string path_;
  std::optional<AtomicFile> file_;
  hal::FrameFormat format_;
  std::int64_t frames_ = 0;
  bool torn_ = false;  // a frame was written in part
};

}  // namespace compueye::firmware
