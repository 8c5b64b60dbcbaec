#pragma once

#include <cstdint>

#include "firmware/pipeline/block_queue.hpp"
#include "firmware/pipeline/device_time.hpp"
#include "firmware/pipeline/frame_slots.hpp"
#include "firmware/pipeline/run_control.hpp"
#include "firmware/pipeline/settings.hpp"
#include "firmware/pipeline/stage_beat.hpp"
#include "hal/accounting.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// Reads the source and copies each block out of it. It does nothing else, so that the device is emptied in time.
class AcquireStage {
 public:
  AcquireStage(const PipelineSettings& settings, hal::SampleSource& source, hal::Clock& clock, RunControl& control,
               BlockQueue<RawSlot>& out, StageBeat& beat) noexcept
      : settings_(settings),
        source_(source),
        clock_(clock),
        control_(control),
        out_(out),
        beat_(beat),
        device_time_(settings.device_clock, source.describe().frame_rate_hz) {}

  /// Until the stream or the run ends.
  void run() noexcept;

  // After the thread was joined:
  [[nodiscard]] hal::FrameAccount account() const noexcept;
  [[nodiscard]] std::uint64_t read_timeouts() const noexcept { return read_timeouts_; }
  [[nodiscard]] std::int64_t recovering_ns() const noexcept { return recovering_ns_; }
  [[nodiscard]] std::uint64_t overrun_flags() const noexcept { return overrun_flags_; }
  [[nodiscard]] std::uint64_t dark_frames() const noexcept { return dark_frames_; }
  [[nodiscard]] std::uint64_t untrusted_times() const noexcept { return untrusted_times_; }

 private:
  [[nodiscard]] hal::Result<hal::SampleBlock> read_source(std::int64_t deadline_ns) noexcept;
  void take(const hal::SampleBlock& block, RawSlot& slot, std::int64_t received_ns) noexcept;
  [[nodiscard]] bool goes_on_after(hal::Error& error, std::int64_t waited_ns) noexcept;

  const PipelineSettings& settings_;
  hal::SampleSource& source_;
  hal::Clock& clock_;
  RunControl& control_;
  BlockQueue<RawSlot>& out_;
  StageBeat& beat_;
  DeviceTime device_time_;
  hal::FrameAccount own_;
  std::uint64_t pushed_ = 0;
  std::int64_t silent_ns_ = 0;  // time in reads that timed out since the last frame
  std::int64_t recovering_ns_ = 0;
  std::uint64_t read_timeouts_ = 0;
  std::uint64_t overrun_flags_ = 0;
  std::uint64_t dark_frames_ = 0;
  std::uint64_t untrusted_times_ = 0;
};

}  // namespace compueye::firmware
