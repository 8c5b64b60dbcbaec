#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/recording/recording_source.hpp"
#include "drivers/recording/replay_source.hpp"
#include "firmware/app/commands/run.hpp"
#include "firmware/eye/board.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"
#include "sim/scene.hpp"

namespace compueye::firmware {

/// Where a run's frames come from: the board's eye, simulated or on a cable, or a recording; and, if asked, the file
/// they go to besides.
class RunSource {
 public:
  /// `frames`: how many are wanted, 0 = all. `clock` must outlive it. Errors: those of board_source() and
  /// ReplaySource::open(); mismatch (a recording of another number of channels or depth than the board's).
  [[nodiscard]] static hal::Result<RunSource> make(const RunOptions& options, const Board& board,
                                                   const sim::Scene& scene, std::uint64_t frames, hal::Clock& clock);

  /// What is tried before the run; nothing of it is recorded.
  [[nodiscard]] hal::SampleSource& unrecorded() noexcept { return *source_; }
  /// What is run.
  [[nodiscard]] hal::SampleSource& source() noexcept;
  /// "sim SIM-8X8", "replay CE-1 from eye.rec".
  [[nodiscard]] std::string name() const;

  // After the run:
  /// What there is to say about the recording that was read or written, a sentence each.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// The first thing that went wrong with the recording that was written.
  [[nodiscard]] hal::Result<void> recorded() const;

 private:
  RunSource() = default;

  std::unique_ptr<hal::SampleSource> source_;
  const recording::ReplaySource* replay_ = nullptr;  // source_, if that is what it is
  std::unique_ptr<recording::RecordingSource> recorder_;
};

}  // namespace compueye::firmware
