#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "firmware/files/growing_file.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// Streams frames into one .npy file of shape (frames, rows, cols), float32, values as they come, while their number is
/// still unknown.
///
/// The file is whole after every frame, so one that is cut short by kill -9 holds what it had. When the disk fills up,
/// write() fails and the frames before stay. write() does not allocate.
class NpySink final : public hal::FrameSink {
 public:
  /// The folder of `file` is made when it is missing. A file that somebody else wrote is never overwritten; one that
  /// this sink wrote before is replaced.
  explicit NpySink(std::string file) : path_(std::move(file)) {}
  NpySink(const NpySink&) = delete;
  NpySink& operator=(const NpySink&) = delete;
  ~NpySink() override;

  /// Errors: usage (rows or cols < 1, already open), those of GrowingFile.
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  /// Errors: usage (not rows * cols pixels, or not open), those of GrowingFile::append().
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  [[nodiscard]] hal::Result<void> close() override;

 private:
  [[nodiscard]] std::size_t pixels() const noexcept;

  std::string path_;
  std::optional<GrowingFile> file_;
  hal::FrameFormat format_;
  std::string header_;
  std::size_t shape_at_ = 0;  // in it
  std::int64_t frames_ = 0;
  bool made_ = false;
};

}  // namespace compueye::firmware
