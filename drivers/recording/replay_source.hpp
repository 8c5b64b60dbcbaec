#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/recording/recording_reader.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::recording {

enum class ReplayPace : std::uint8_t {
  recorded,  ///< each frame as long after start() as it came after the recording's start
  fast,      ///< the next frame whenever one is read
};

/// A recording as a source: the recorded frames bit for bit, with their numbers, times and flags, and the account that
/// the recorded source had (RecordingReader::account()).
///
/// describe() is the recorded description with "replay" as its back end. start() begins at the first frame again. A
/// late reader loses nothing: a recording waits.
class ReplaySource final : public hal::SampleSource {
 public:
  /// `clock` must outlive it. Errors: those of RecordingReader::open().
  [[nodiscard]] static hal::Result<std::unique_ptr<ReplaySource>> open(const std::string& path, ReplayPace pace,
                                                                       hal::Clock& clock);
  ReplaySource(RecordingReader recording, ReplayPace pace, hal::Clock& clock);

  /// What was read so far, for its header, damage and end.
  [[nodiscard]] const RecordingReader& recording() const noexcept { return recording_; }

 private:
  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return description_; }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override { next_.reset(); }
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override { return account_; }
  [[nodiscard]] std::uint64_t do_faults() const noexcept override { return faults_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override;

  RecordingReader recording_;
  ReplayPace pace_;
  hal::Clock& clock_;
  hal::SourceDescription description_;
  std::int64_t started_ns_ = 0;
  std::optional<RecordedFrame> next_;  // read, and not yet due
  hal::FrameAccount account_;
  std::atomic<std::uint64_t> faults_{0};
};

}  // namespace compueye::recording
