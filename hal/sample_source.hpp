#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/accounting.hpp"
#include "hal/counter.hpp"
#include "hal/result.hpp"
#include "hal/sample_block.hpp"

namespace compueye::hal {

/// What a source is, known before it is started.
struct SourceDescription {
  std::string backend;   ///< "sim", "usb", "hid", "spi", "replay"
  std::string serial;    ///< unique among devices of one backend
  std::string firmware;  ///< the device's own version string
  int channels = 0;      ///< M
  int bits = 0;          ///< depth of the codes
  double frame_rate_hz = 0.0;
  std::vector<std::int32_t> ommatidium_of_channel;  ///< M entries: channel -> ommatidium (row of A)
  std::string provenance = {};  ///< lines "key = value" on how samples come about that no photodiode made; else empty
};

/// A stream of frames of samples: an eye on a bus, a simulated eye or a recording.
///
/// One thread calls read(); stop() may come from another thread only between reads. After start(), read() neither
/// allocates nor throws. Every back end passes tests/hal/sample_source_contract.hpp.
class SampleSource {
 public:
  SampleSource() = default;
  SampleSource(const SampleSource&) = delete;
  SampleSource& operator=(const SampleSource&) = delete;
  virtual ~SampleSource() = default;

  [[nodiscard]] const SourceDescription& describe() const noexcept { return do_describe(); }

  /// Begins a new stream: frame numbers and accounting restart at 0. Starting twice without stop() is a usage error.
  [[nodiscard]] Result<void> start();

  /// The next frame, waiting until `deadline_ns` (of the Clock the source was made with) at most.
  /// Errors: timeout (try again), end_of_stream, disconnected, usage (not started). Never a stale frame: frames lost
  /// before the one returned are in account().dropped, and its `frame` number has jumped by as many.
  [[nodiscard]] Result<SampleBlock> read(std::int64_t deadline_ns);

  /// Ends the stream; idempotent. A later start() begins anew.
  void stop() noexcept;

  [[nodiscard]] bool started() const noexcept { return started_; }

  /// Since the last start(): produced by the device = delivered by read() + dropped by reason + taken for checks.
  [[nodiscard]] FrameAccount account() const noexcept { return do_account(); }

  /// Whether it lost its device or its stream and is getting it back; from any thread. read() times out meanwhile, and
  /// this ends by itself, in a time that the source bounds: with a frame, or with a read() that says `disconnected`.
  [[nodiscard]] bool recovering() const noexcept { return do_recovering(); }

  /// Whether frames came in the last read() that timed out, and were kept for a check of the eye: no silence. For the
  /// thread that reads.
  [[nodiscard]] bool withheld() const noexcept { return do_withheld(); }

  /// How often it lost its device or its stream since the last start(); for the thread that reads.
  [[nodiscard]] std::uint64_t outages() const noexcept { return do_outages(); }

  /// How many things went wrong so far, faults_in(counters()); from any thread, and as of the last read().
  [[nodiscard]] std::uint64_t faults() const noexcept { return do_faults(); }

  /// What else this kind of source counts, since the last start(): what went wrong and was mended. Always the same
  /// rows in the same order, none where there is nothing to tell. Not for the frame path: it allocates.
  [[nodiscard]] std::vector<Counter> counters() const { return do_counters(); }

 private:
  [[nodiscard]] virtual const SourceDescription& do_describe() const noexcept = 0;
  virtual Result<void> do_start() = 0;
  virtual Result<SampleBlock> do_read(std::int64_t deadline_ns) = 0;
  virtual void do_stop() noexcept = 0;
  [[nodiscard]] virtual FrameAccount do_account() const noexcept = 0;
  [[nodiscard]] virtual bool do_recovering() const noexcept { return false; }
  [[nodiscard]] virtual bool do_withheld() const noexcept { return false; }
  [[nodiscard]] virtual std::uint64_t do_outages() const noexcept { return 0; }
  [[nodiscard]] virtual std::uint64_t do_faults() const noexcept { return 0; }
  [[nodiscard]] virtual std::vector<Counter> do_counters() const { return {}; }

  bool started_ = false;
};

}  // namespace compueye::hal
