#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/recording/recording_source.hpp"
#include "drivers/recording/replay_source.hpp"
#include "firmware/app/commands/run.hpp"
#include "firmware/calibration/checked_source.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/source_list.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"
#include "sim/scene/scene.hpp"

namespace compueye::firmware {

/// What of an eye's frames is kept, and what the recording's header says of them, for people.
struct RecordingRequest {
  std::string path;
  std::string scene;
  std::uint64_t scene_seed = 0;
  std::uint64_t seed = 0;
  bool lossless = false;         ///< waits for the disk
  bool stop_on_failure = false;  ///< frames end when the file fails
  std::string pictures = {};     ///< lines that say how pictures were made of the frames meanwhile, if they were
};

/// Whether a recording can be begun at `path`, so that it is known before the set-up and not after. Errors: io (there
/// is one already), not_found (no such folder).
[[nodiscard]] hal::Result<void> check_new_recording(const std::string& path);

/// `source` with a recorder; it and `clock` must outlive that. Of an eye on a cable nobody knows the scene. Errors:
/// those of RecordingSource::create().
[[nodiscard]] hal::Result<std::unique_ptr<recording::RecordingSource>> with_recorder(const RecordingRequest& request,
                                                                                     const Board& board,
                                                                                     hal::SampleSource& source,
                                                                                     hal::Clock& clock);

/// Where a run's frames come from: the board's eye, simulated or on a cable, or a recording; and, if asked, the file
/// they go to besides.
class RunSource {
 public:
  /// `frames`: how many are wanted, 0 = all. `clock` must outlive it. Errors: those of board_source() and
  /// ReplaySource::open(); mismatch (a recording of another number of channels or depth than the board's).
  [[nodiscard]] static hal::Result<RunSource> make(const RunOptions& options, const Board& board,
                                                   const sim::Scene& scene, std::uint64_t frames, hal::Clock& clock,
                                                   const recon::Progress& progress);
  /// A simulated eye's frame that is rendered is given up once this is false.
  void render_while(std::function<bool()> go_on);
  /// Frames of checks are taken out of what is run and recorded. Before a recording is begun.
  void add_checks(CheckSettings settings, hal::Clock& clock);

  /// Where the options ask for a recording, its file is begun, with the lambda and the measured response that is run
  /// with. Errors: those of with_recorder().
  [[nodiscard]] hal::Result<void> begin_recording(const RunOptions& options, const Board& board,
                                                  const sim::Scene& scene, const ReadyEye& eye, hal::Clock& clock);

  /// What is tried before the run; nothing of it is recorded.
  [[nodiscard]] hal::SampleSource& unrecorded() noexcept { return *eye_.source; }
  [[nodiscard]] const BoardEye& eye() const noexcept { return eye_; }
  /// What is run.
  [[nodiscard]] hal::SampleSource& source() noexcept;
  /// Of the device, which may be behind a recording.
  [[nodiscard]] const std::string& serial() const noexcept { return eye_.source->describe().serial; }
  /// "sim SIM-8X8", "replay CE-1 from eye.rec".
  [[nodiscard]] std::string name() const;
  /// Where the recording's board was another one, a sentence; empty: it was not, or there is no recording.
  [[nodiscard]] const std::string& mismatch() const noexcept { return mismatch_; }

  /// The lambda of the run that made the recording, if its rule gave the same as `eye`'s: only then are both of the
  /// same problem.
  [[nodiscard]] std::optional<double> recorded_lambda(const ReadyEye& eye) const;

  /// What went wrong with the recording so that nothing more can be written, and what follows: empty as long as nothing
  /// did. From any thread.
  [[nodiscard]] std::string failure() const;

  /// Nothing: no check was asked for.
  [[nodiscard]] const CheckedSource* checks() const noexcept { return checked_.get(); }
  /// From any thread, as what a check saw.
  void look_again() noexcept {
    if (checked_) checked_->look_again();
  }
  [[nodiscard]] std::optional<CheckLook> next_look() {
    return checked_ ? checked_->next_look() : std::optional<CheckLook>();
  }

  // After the run:
  /// What there is to say about the recording that was read or written, and of an eye that could not be stopped, a
  /// sentence each.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// The first thing that went wrong with the recording that was written.
  [[nodiscard]] hal::Result<void> recorded() const;

 private:
  RunSource() = default;

  BoardEye eye_;                                     // neither of both: a recording
  const recording::ReplaySource* replay_ = nullptr;  // the source, if that is what it is
  std::string mismatch_;
  std::unique_ptr<CheckedSource> checked_;
  std::unique_ptr<recording::RecordingSource> recorder_;
};

}  // namespace compueye::firmware
