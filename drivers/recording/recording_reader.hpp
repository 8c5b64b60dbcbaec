#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/recording/recording_block.hpp"
#include "drivers/recording/recording_file.hpp"
#include "drivers/recording/recording_header.hpp"
#include "hal/accounting.hpp"
#include "hal/result.hpp"
#include "hal/sample_block.hpp"

namespace compueye::recording {

/// A frame read back. Its spans are the reader's and valid until its next call.
struct RecordedFrame {
  hal::SampleBlock block;
  std::int64_t arrival_ns = 0;  ///< when the recording host had it, since the recording's start
};

/// What a reader met besides whole blocks, since the beginning of the file.
struct RecordingDamage {
  std::uint64_t stretches = 0;  ///< pieces of the file between whole blocks that are none
  std::uint64_t bytes = 0;      ///< in them
  std::uint64_t first_at = 0;   ///< offset of the first one, if there is any
  std::uint64_t blocks = 0;   ///< frame blocks lost in them, by the numbers of those that follow; at the end by length
  std::uint64_t torn_at = 0;  ///< offset of the torn tail, if there is one
  std::uint64_t torn_bytes = 0;  ///< a last block that was never finished, as a killed process leaves it
};

/// How a recording was ended in order; see Ending.
struct RecordedEnd {
  Ending ending = Ending::stopped;
  std::int64_t at_ns = 0;  ///< Clock time since the recording's start
};

/// Reads a recording (docs/recordings.md) from front to back. Nothing in the file is believed before it was checked:
/// lengths against the format's limits and the file's size before memory is taken, every block by its CRCs, its order
/// by index, frame number and counters that do not fall. What is damaged is stepped over to the next whole block.
///
/// After open(), next() allocates on failure of the operating system only.
class RecordingReader {
 public:
  /// Reads and checks the header. Errors: those of stored_file(), stated_header_bytes() and parse_header().
  [[nodiscard]] static hal::Result<RecordingReader> open(const std::string& path);
  [[nodiscard]] static hal::Result<RecordingReader> over(std::unique_ptr<StoredBytes> bytes);

  [[nodiscard]] const RecordingHeader& header() const noexcept { return header_; }
  [[nodiscard]] const std::string& place() const noexcept { return bytes_->place(); }
  [[nodiscard]] std::uint64_t file_bytes() const noexcept { return bytes_->size(); }

  /// The next frame. Errors: end_of_stream (without text), io.
  [[nodiscard]] hal::Result<RecordedFrame> next();
  /// Back to the first block.
  void rewind() noexcept;

  // About what was read so far:
  /// The account that the recording source had, frames that are not in the file among the dropped: damaged blocks as
  /// corrupt; those that the writer was too slow for, and jumps of the frame number that no counter explains, as
  /// transport_gap. Always balanced, and frame + 1 - delivered <= total_dropped() after each frame.
  [[nodiscard]] hal::FrameAccount account() const noexcept;
  [[nodiscard]] std::uint64_t frames() const noexcept { return delivered_; }
  /// Offset behind the last whole block.
  [[nodiscard]] std::uint64_t position() const noexcept { return at_; }
  [[nodiscard]] std::uint64_t unrecorded() const noexcept { return last_.unrecorded; }
  [[nodiscard]] const RecordingDamage& damage() const noexcept { return damage_; }
  /// Nothing for a recording that was cut off, or before its end.
  [[nodiscard]] const std::optional<RecordedEnd>& end() const noexcept { return end_; }

 private:
  RecordingReader() = default;

  struct Found {
    BlockHead head;
    std::span<const std::byte> bytes;
  };
  [[nodiscard]] hal::Result<std::span<const std::byte>> window(std::uint64_t offset, std::size_t count);
  [[nodiscard]] hal::Result<std::optional<Found>> block_at(std::uint64_t offset);
  [[nodiscard]] hal::Result<std::optional<Found>> next_block();
  [[nodiscard]] hal::Result<std::uint64_t> next_candidate(std::uint64_t offset);
  [[nodiscard]] hal::Result<bool> begins_block(std::uint64_t offset);
  void note_damage(std::uint64_t from, std::uint64_t to) noexcept;
  [[nodiscard]] hal::Result<void> note_tail(std::uint64_t from);

  std::unique_ptr<StoredBytes> bytes_;
  RecordingHeader header_;
  std::uint64_t first_block_at_ = 0;
  std::size_t frame_bytes_ = 0;
  std::vector<std::byte> buffer_;  // a window on the file
  std::uint64_t buffer_at_ = 0;
  std::size_t buffer_size_ = 0;
  std::vector<std::int32_t> codes_;
  std::vector<std::uint8_t> valid_;

  std::uint64_t at_ = 0;  // behind the last whole block
  bool over_ = false;
  std::uint64_t delivered_ = 0;
  std::optional<std::uint64_t> last_frame_;
  RecordedBooks last_;  // of the last whole block; its index counts the frame blocks up to and with it
  RecordingDamage damage_;
  std::optional<RecordedEnd> end_;
};

}  // namespace compueye::recording
