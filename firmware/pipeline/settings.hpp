#pragma once

#include <cstdint>
#include <functional>

#include "firmware/pipeline/block_queue.hpp"
#include "firmware/pipeline/correction.hpp"
#include "firmware/pipeline/device_time.hpp"
#include "firmware/pipeline/stage_beat.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// How a run behaves, decided before it begins. Times in ns.
struct PipelineSettings {
  Pacing pacing = Pacing::newest_wins;
  std::uint64_t frames = 0;  ///< end after so many delivered frames; 0: run until stopped or the stream ends
  std::int64_t deadline_ns =
      0;  ///< age at which a published frame counts as late (it is published all the same); 0: none

  /// Frames that may wait between two stages, 1..1024. With newest_wins it bounds only what waits for correction: one
  /// frame at most waits for the solver, since any older one would only be older.
  int queue_capacity = 4;

  std::int64_t read_timeout_ns = 100'000'000;  ///< > 0: longest single read; how fast a stop request is noticed
  /// >= 0: a source silent for so long has failed; 0: wait for ever. Not while it is SampleSource::recovering(), which
  /// has a limit of its own: longer than a source takes to find out that it should.
  std::int64_t silence_limit_ns = 5'000'000'000;
  DeviceClock device_clock = DeviceClock::host;
  bool stop_on_sink_failure = true;     ///< false: count the frame as sink_failed and go on
  std::uint64_t config_patience = 100;  ///< consecutive frames with a foreign config_id that end the run; 0: never

  CorrectionSettings correction;

  StageBeats* beats = nullptr;  ///< for whoever watches the run; must outlive the pipeline. Null: nobody does
  /// Called by each stage's thread before its first frame, by that of publish too; may be empty.
  std::function<void(Stage)> thread_begins;

  /// out_of_range names the setting. The correction settings are checked against the source, by Correction::create().
  [[nodiscard]] hal::Result<void> validate() const;
};

}  // namespace compueye::firmware
