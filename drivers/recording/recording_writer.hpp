#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
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

/// Writes a recording (docs/recordings.md), block by block.
///
/// Each block is one write() from a buffer of one block, so a process that is killed loses no block but the one it was
/// writing, which a reader sees as a torn tail. Against power cuts the file is flushed to the disk whenever
/// `sync_interval_ns` has passed since the last time, also while no frames come if flush_if_due() is called, and at the
/// end; the folder that it was made in is flushed at once.
///
/// When the disk is full or a write fails, the file is cut back to its last whole block and append() says why; nothing
/// more is then written but the end block with the frames that are missing, on a full disk in the place of the last
/// frame if there is no room for it. A pipe that takes nothing for `stall_limit` has failed.
class RecordingWriter {
 public:
  static constexpr std::int64_t default_sync_interval_ns = 1'000'000'000;
  static constexpr std::chrono::seconds stall_limit{30};

  /// Makes the file and writes the header. A file or link that exists is refused (io): recordings are never
  /// overwritten; a device or a pipe that exists and has a reader is written to, and "-" is the standard output.
  /// `sync_interval_ns` 0: only at the end. Errors besides: those of check_header(), not_found (no such folder),
  /// no_space.
  [[nodiscard]] static hal::Result<RecordingWriter> create(const std::string& path, const RecordingHeader& header,
                                                           std::int64_t sync_interval_ns = default_sync_interval_ns);

  /// Appends one frame. `arrival_ns`: Clock time since the recording's start, >= 0; `account`: the source's, with this
  /// frame; `unrecorded`: frames so far that were delivered and not appended. Allocates on failure only.
  /// Errors: mismatch (another number of channels or depth,
  /// a frame number or counter that fell), out_of_range (a code, counter or time beyond the format),
  /// no_space and io, after which the writer accepts nothing more.
  [[nodiscard]] hal::Result<void> append(const hal::SampleBlock& block, std::int64_t arrival_ns,
                                         const hal::FrameAccount& account, std::uint64_t unrecorded);

  /// Flushes to the disk what was appended longer than `sync_interval_ns` ago. `now_ns`: Clock time since the
  /// recording's start. Errors: io, after which the writer accepts nothing more.
  [[nodiscard]] hal::Result<void> flush_if_due(std::int64_t now_ns);

  /// The file is of no use: closes it, and removes it if it was made here.
  void discard() noexcept;

  /// Appends the end block, flushes to the disk and closes. Call it once, whatever append() returned; on a full disk
  /// frames() may be one less after it.
  [[nodiscard]] hal::Result<void> finish(Ending ending, std::int64_t at_ns, const hal::FrameAccount& account,
                                         std::uint64_t unrecorded);

  /// Whether a write has failed, after which nothing more is written.
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }
  /// Of the file: all of them in whole blocks.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  RecordingWriter() = default;
  [[nodiscard]] hal::Result<void> write(std::span<const std::byte> bytes);
  [[nodiscard]] hal::Result<void> put(std::span<const std::byte> bytes);
  void end_in_place_of_last_frame(BlockHead head) noexcept;

  OpenFile file_;
  std::string path_;
  bool regular_ = true;
  bool failed_ = false;
  int bits_ = 0;
  std::size_t channels_ = 0;
  std::vector<std::byte> buffer_;  // one frame block
  RecordedBooks last_;
  std::optional<std::uint64_t> last_frame_;
  std::uint64_t frames_ = 0;
  std::uint64_t bytes_ = 0;
  std::int64_t sync_interval_ns_ = 0;
  std::int64_t last_sync_ns_ = 0;
  bool flushed_ = true;
};

}  // namespace compueye::recording
