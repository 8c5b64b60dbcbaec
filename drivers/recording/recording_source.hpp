#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "drivers/recording/recording_writer.hpp"
#include "drivers/recording/waiting_frames.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::recording {

/// What happens to a frame when the file cannot keep up.
enum class WhenFull : std::uint8_t {
  skip,  ///< it is delivered, not recorded and counted: for an eye that does not wait
  wait,  ///< the reader waits for the disk: for a source that makes its frames when they are read
};

struct RecordingSettings {
  std::string path;                      ///< of the first run; the n-th goes to "<stem>-<n><extension>"
  std::string settings;                  ///< for the header, lines "key = value"
  std::int64_t unix_minus_clock_ns = 0;  ///< wall clock minus Clock, for the header
  WhenFull when_full = WhenFull::skip;
  std::size_t most_waiting_bytes = 16U << 20U;  ///< in the queue; at least 4 frames fit whatever they take
  std::int64_t sync_interval_ns = RecordingWriter::default_sync_interval_ns;
  bool stop_on_failure = false;  ///< read() ends with the file's failure; otherwise frames go on without it
};

/// Another source, every frame of which is also written to a file. What the reader sees is the other source unchanged.
///
/// read() copies the frame into a bounded queue, for which it neither allocates nor waits (except with
/// WhenFull::wait), and a thread of its own writes. Frames that found the queue full or could not be written are
/// counted in unrecorded() and in the file. The file reaches the disk by time, also while no frames come, as long as
/// somebody reads. stop() writes what waits and the end block.
class RecordingSource final : public hal::SampleSource {
 public:
  /// `source` and `clock`, which is the source's, must outlive it. Errors: those of check_header().
  [[nodiscard]] static hal::Result<std::unique_ptr<RecordingSource>> create(RecordingSettings settings,
                                                                            hal::SampleSource& source,
                                                                            hal::Clock& clock);
  RecordingSource(const RecordingSource&) = delete;
  RecordingSource& operator=(const RecordingSource&) = delete;
  ~RecordingSource() override;

  /// Where the current or last run goes.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  // Of the current or last run, from any thread:
  [[nodiscard]] std::uint64_t recorded() const noexcept { return recorded_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t unrecorded() const noexcept {
    return skipped_.load(std::memory_order_relaxed) + refused_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_.load(std::memory_order_relaxed); }
  /// True as soon as nothing more can be written.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }
  [[nodiscard]] bool stops_on_failure() const noexcept { return settings_.stop_on_failure; }
  /// The first thing that went wrong with the file. After stop(), or once failed().
  [[nodiscard]] const std::optional<hal::Error>& error() const noexcept { return error_; }

 private:
  RecordingSource(RecordingSettings settings, hal::SampleSource& source, hal::Clock& clock)
      : settings_(std::move(settings)), source_(source), clock_(clock) {}

  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return source_.describe(); }
  hal::Result<void> do_start() override;
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override;
  void do_stop() noexcept override;
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override { return source_.account(); }
  [[nodiscard]] bool do_recovering() const noexcept override { return source_.recovering(); }
  [[nodiscard]] bool do_withheld() const noexcept override { return source_.withheld(); }
  [[nodiscard]] std::uint64_t do_outages() const noexcept override { return source_.outages(); }
  [[nodiscard]] std::uint64_t do_faults() const noexcept override { return source_.faults(); }
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override { return source_.counters(); }

  void keep(const hal::SampleBlock& block) noexcept;
  void look_after_file() noexcept;
  void write_waiting() noexcept;
  void note(hal::Result<void> done) noexcept;

  RecordingSettings settings_;
  hal::SampleSource& source_;
  hal::Clock& clock_;

  int runs_ = 0;
  std::string path_;
  std::int64_t started_ns_ = 0;
  Ending ending_ = Ending::stopped;
  std::optional<RecordingWriter> writer_;
  std::unique_ptr<WaitingFrames> waiting_;
  std::thread thread_;
  std::atomic<std::uint64_t> recorded_{0};
  std::atomic<std::uint64_t> skipped_{0};  // by the reader: no room
  std::atomic<std::uint64_t> refused_{0};  // by the writer's thread
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<bool> failed_{false};
  std::optional<hal::Error> error_;  // the writer's thread's until failed_
  std::int64_t looked_ns_ = 0;       // the reader's: when the file was last looked after
  std::atomic<std::int64_t> now_ns_{0};
};

}  // namespace compueye::recording
