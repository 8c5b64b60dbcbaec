#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/report.hpp"
#include "firmware/eye/picture_quality.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "firmware/eye/reconstructor_maker.hpp"
#include "firmware/operating_points/deadline_choice.hpp"
#include "firmware/pipeline/run_summary.hpp"

namespace compueye::firmware {

/// What a run with stored points says about its deadline.
struct LadderReport {
  struct Rung {
    std::string point;  ///< "admm dct, 30 iterations"
    double nmse = 0.0;  ///< mean on the evaluation scenes
    double p999_ms = 0.0;
    std::uint64_t frames = 0;  ///< delivered
  };
  double deadline_ms = 0.0;
  double age_ms = 0.0;
  bool fits = false;
  std::uint64_t memory_bytes = 0;
  std::vector<Rung> rungs;
  std::uint64_t steps_down = 0;
  std::uint64_t steps_up = 0;
  std::string sentence;
};

/// What is fixed before the first frame.
struct EyeFigures {
  std::string board;
  std::string source;  ///< back end and serial
  int ommatidia = 0;
  int blind = 0;  ///< see nothing of the object plane
  int dead = 0;   ///< listed as dead
  int image_rows = 0;
  int image_cols = 0;
  double frame_rate_hz = 0.0;
  LambdaChoice lambda;
  double rho = 0.0;
  recon::OperatingPoint point;
  FactorOrigin factor = FactorOrigin::made;
  std::uint64_t workspace_bytes = 0;
  std::uint64_t table_bytes = 0;
};

/// Everything `compueye run` has to say when it is over.
struct RunReport {
  EyeFigures eye;
  std::string scene;
  std::int64_t seed = 0;
  double distance_mm = 0.0;
  bool lossless = false;
  double setup_s = 0.0;
  std::optional<DeadlineChoice> deadline;  ///< by trial
  std::optional<LadderReport> ladder;      ///< by stored points
  RunSummary summary;
  std::optional<PictureQuality> quality;  ///< mean over `measured` delivered frames
  std::size_t measured = 0;
  std::optional<PictureQuality> last_quality;  ///< of the last delivered frame
  std::optional<PictureQuality> conventional;  ///< of one frame
  std::vector<std::string> files;              ///< what was written
  std::vector<std::string> notes;
};

/// For people: a few lines and a table of times.
[[nodiscard]] std::string report_text(const RunReport& report);

/// For machines: every figure, under keys with the unit in their name.
[[nodiscard]] Figures report_figures(const RunReport& report);

/// A table with a row a run, of columns as wide in every run, so that a script can put rows below one header.
[[nodiscard]] std::string table_header();
[[nodiscard]] std::string table_row(const RunReport& report);

}  // namespace compueye::firmware
