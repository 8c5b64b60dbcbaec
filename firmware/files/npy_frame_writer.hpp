#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Streams pictures into one .npy file of shape (frames, rows, cols), float32, while their number is still unknown.
///
/// The file has its name only after close(), and is then whole; until then, and after a crash, it is a *.partial file.
/// When the disk fills up, write() fails, and close() still delivers the frames that were written whole. write() does
/// not allocate.
class NpyFrameWriter {
 public:
  /// Errors: usage (rows or cols < 1), those of AtomicFile, unsupported for a device or pipe.
  [[nodiscard]] static hal::Result<NpyFrameWriter> create(const std::filesystem::path& path, int rows, int cols);

  NpyFrameWriter(const NpyFrameWriter&) = delete;
  NpyFrameWriter& operator=(const NpyFrameWriter&) = delete;
  NpyFrameWriter(NpyFrameWriter&&) noexcept = default;
  NpyFrameWriter& operator=(NpyFrameWriter&&) noexcept = default;
  /// Without close() nothing is kept.
  ~NpyFrameWriter() = default;

  /// Errors: usage (not rows * cols pixels, or closed), those of AtomicFile::write().
  [[nodiscard]] hal::Result<void> write(std::span<const float> pixels);

  /// Writes the number of frames into the header and makes the file appear. Idempotent.
  [[nodiscard]] hal::Result<void> close();

  [[nodiscard]] std::int64_t frames() const noexcept { return frames_; }

 private:
  explicit NpyFrameWriter(AtomicFile file) : file_(std::move(file)) {}

  std::optional<AtomicFile> file_;
  std::filesystem::path path_;
  int rows_ = 0;
  int cols_ = 0;
  std::int64_t frames_ = 0;
  bool torn_ = false;  // a frame was written in part
};

}  // namespace compueye::firmware
