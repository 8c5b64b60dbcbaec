#pragma once

#include <optional>
#include <string>
#include <utility>

#include "firmware/files/png.hpp"
#include "hal/frame_sink.hpp"

namespace compueye::firmware {

/// Writes each frame as a grey PNG "frame-000000.png", named by the frame's own number so that a lost one shows as a
/// gap. Intensities 0..1 become the codes 0..2^bits-1, clipped, NaN as 0.
///
/// Each file is whole as soon as it has its name. It is not flushed to the disk one by one, which a memory card could
/// not keep up with: close() flushes the folder. After open(), write() does not allocate: libpng works in memory set
/// aside for it.
class PngSequenceSink final : public hal::FrameSink {
 public:
  /// `bits` is 8 or 16.
  explicit PngSequenceSink(std::string folder, int bits = 8) : folder_(std::move(folder)), bits_(bits) {}
  PngSequenceSink(const PngSequenceSink&) = delete;
  PngSequenceSink& operator=(const PngSequenceSink&) = delete;
  ~PngSequenceSink() override;

  /// Makes the folder when it is missing and tries whether it can be written. Errors: usage (bits, size, already open),
  /// otherwise those of a file that cannot be written.
  [[nodiscard]] hal::Result<void> open(hal::FrameFormat format) override;
  [[nodiscard]] hal::Result<void> write(const hal::Frame& frame) override;
  [[nodiscard]] hal::Result<void> close() override;

 private:
  [[nodiscard]] hal::Result<void> try_folder();

  std::string folder_;
  int bits_;
  hal::FrameFormat format_;
  std::optional<PngEncoder> encoder_;
  // Room for the longest name, so that write() only prints into them.
  std::string name_;
  std::string partial_;
};

}  // namespace compueye::firmware
