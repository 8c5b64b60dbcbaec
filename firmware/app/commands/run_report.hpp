#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/eye/picture_quality.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/operating_points/deadline_choice.hpp"
#include "firmware/operating_points/point_choice.hpp"
#include "firmware/pipeline/fit_watch.hpp"
#include "firmware/pipeline/run_summary.hpp"
#include "firmware/text/figures.hpp"
#include "recon/channel_detector.hpp"

namespace compueye::firmware {

/// What a run with stored points came to.
struct LadderRun {
  Sweep points;
  PointChoice choice;
  std::vector<std::uint64_t> frames;  ///< delivered, by rung
  std::uint64_t steps_down = 0;
  std::uint64_t steps_up = 0;

  /// Which point was chosen and why.
  [[nodiscard]] std::string sentence() const;
};

/// What a run came to, step by step.
struct RunReport {
  std::string source;  ///< back end and serial
  std::string scene;
  std::uint64_t seed = 0;
  bool lossless = false;
  double setup_s = 0.0;
  std::uint64_t setup_peak_bytes = 0;      ///< the most memory of the process until its first frame
  std::optional<DeadlineChoice> deadline;  ///< by trial
  std::optional<LadderRun> ladder;         ///< by stored points
  RunSummary summary;
  FitSummary fit;
  std::optional<recon::ChannelDetector> channels;  ///< where dead ones were looked for
  std::optional<PictureQuality> quality;           ///< mean over `measured` delivered frames
  std::size_t measured = 0;
  std::optional<PictureQuality> last_quality;  ///< of the last delivered frame
  std::optional<PictureQuality> conventional;  ///< of one frame
  Figures picture;                             ///< how long it was live, held, gone; what real time was granted
  std::uint64_t interruptions = 0;             ///< times it was held or gone
  std::optional<Figures> checks;               ///< of the eye, where they were asked for
  std::vector<std::string> files;              ///< what was written
  std::vector<std::string> notes;
};

/// Everything `compueye run` has to say when it is over: for people a few lines and a table of times, for machines
/// every figure, under keys with the unit in their name.
[[nodiscard]] Figures figures_of(const RunReport& report, const Board& board, const ReadyEye& eye);

/// A table with a row a run, of columns as wide in every run, so that a script can put rows below one header.
[[nodiscard]] std::string table_header();
[[nodiscard]] std::string table_row(const Figures& run);

}  // namespace compueye::firmware
