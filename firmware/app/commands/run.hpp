#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/recording/replay_source.hpp"
#include "firmware/app/option_list.hpp"
#include "firmware/app/session.hpp"
#include "firmware/calibration/lights.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What `compueye run` was asked for.
struct RunOptions {
  std::string board;
  std::optional<std::int64_t> frames;  ///< delivered pictures, 0 = until stopped; absent: the board's frames_per_scene
  std::optional<double> deadline_ms;   ///< > 0
  SceneChoice scene;
  std::uint64_t seed = 0;    ///< of the noise
  std::string out;           ///< folder for pictures
  std::string format;        ///< a word of sink_formats(); empty: png with `out`, else none
  std::optional<bool> show;  ///< absent: when stdout is a terminal
  bool lossless = false;
  std::string replay;       ///< a recording instead of the board's eye; empty: none
  std::string replay_pace;  ///< fast or recorded; empty: fast
  std::string record;       ///< where the frames go besides; empty: nowhere
  bool stop_if_unrecorded = false;
  std::optional<bool> lambda_from_samples;  ///< false: by rule; absent: as recorded, else by rule
  Overrides overrides;                      ///< iterations, threads, lambda, sigma, distance
  std::optional<double> check_every_s;      ///< of the eye's own time, > 0; absent: no checks
  std::optional<double> check_warm_up_s;    ///< >= 0; absent: the session's
  LightWanted light;                        ///< of checks
  std::string sheet;
  std::string report;
  std::string table;         ///< header, row or both; empty: no table
  std::string stdout_owner;  ///< the option that has standard output to itself, if any

  /// Contradictions and values out of range. Error usage names the option.
  [[nodiscard]] hal::Result<void> check() const;
  [[nodiscard]] std::string output_format() const;
  [[nodiscard]] recording::ReplayPace pace() const noexcept {
    return replay_pace == "recorded" ? recording::ReplayPace::recorded : recording::ReplayPace::fast;
  }
  [[nodiscard]] bool replays() const noexcept { return !replay.empty(); }
  /// Every frame is waited for: as asked, and when a recording is replayed as fast as it can be.
  [[nodiscard]] bool waits_for_frames() const noexcept {
    return lossless || (replays() && pace() == recording::ReplayPace::fast);
  }
  /// Whether the scene in front of the eye is known, to compare pictures with: a recording's is only when it is named.
  [[nodiscard]] bool knows_scene() const noexcept { return !replays() || !scene.name.empty(); }
};

/// `compueye run`: makes the board ready, runs the pipeline on it and reports. A run that fails after its first frame
/// is reported before.
[[nodiscard]] hal::Result<void> run_board(const RunOptions& options, Session& session);

}  // namespace compueye::firmware
