#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/eye/picture_quality.hpp"
#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/text/figures.hpp"
#include "hal/clock.hpp"
#include "hal/image.hpp"
#include "recon/core/frame/frame_info.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// What is compared, and on which samples of a board's eye.
struct CompareOptions {
  SceneChoice scene;                 ///< on the object plane
  std::uint64_t seed = 0;            ///< of the noise
  bool exact = false;                ///< y = A x + n instead of the simulated eye
  std::string response;              ///< file of another A for the board's eye; empty: the board's living_response()
  std::vector<std::string> solvers;  ///< empty: all
  std::vector<std::string> bases;    ///< empty: all
};

/// A solver with a basis and constraint it takes.
struct Contender {
  recon::SolverKind solver = recon::default_solver();
  recon::BasisKind basis = recon::BasisKind::identity;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;
};

/// Everything that goes together, by basis and then by solver: with `wanted` where the pair takes it, else with none.
/// Error usage for a name that does not exist, or when nothing is left.
[[nodiscard]] hal::Result<std::vector<Contender>> contenders(const CompareOptions& options,
                                                             recon::ConstraintKind wanted);

/// What one contender made of the samples.
struct ComparedRow {
  Contender contender;
  double lambda = 0.0;
  int rank = 0;  ///< tsvd
  recon::FrameInfo info;
  double solve_ms = 0.0;  ///< median
  double setup_s = 0.0;
  std::uint64_t workspace_bytes = 0;
  std::uint64_t table_bytes = 0;
  PictureQuality quality;
  hal::Image picture;
  /// Objective over the least one of the same problem (basis, constraint, lambda), less 1; none for solvers whose
  /// objective is another.
  std::optional<double> excess;
};

struct Comparison {
  std::string board;
  std::string scene;
  bool exact = false;
  std::shared_ptr<const MeasuredEye> measured;  ///< null: the nominal response, or another one
  double sigma = 0.0;
  std::uint64_t seed = 0;
  std::uint64_t scene_seed = 0;
  int channels = 0;
  int seeing = 0;
  int threads = 1;  ///< that shared a frame's work
  hal::Image truth;
  std::optional<hal::Image> conventional;
  std::optional<PictureQuality> conventional_quality;
  std::vector<ComparedRow> rows;
  std::size_t planned = 0;           ///< rows that there would be without a stop or a failure
  std::vector<std::string> missing;  ///< "basis constraint solver" of each that was planned and is not there
  std::vector<std::string> notes;    ///< sentences for the user
};

/// Takes one frame of samples and solves it in every way: iterations are those of the board where a command line states
/// them (Board::overrules()), else the board's for solvers that have a factor and ten times that for the others; lambda
/// likewise the command line's, else the board's for its own basis, else by rule. A stop (`progress` returning false)
/// keeps the rows that are done; a contender that cannot be set up or solved becomes a note. Errors: those of
/// contenders() and take_samples(); when there is no row at all that of the first contender, or interrupted.
[[nodiscard]] hal::Result<Comparison> compare(const Board& board, const CompareOptions& options,
                                              const hal::Clock& clock, const recon::Progress& progress);

/// Every figure of a row, the same keys in the same order for each; null: the row has none.
[[nodiscard]] Figures figures_of(const ComparedRow& row);

/// The row with the least NMSE; null when there is none.
[[nodiscard]] const ComparedRow* best_of(const Comparison& comparison);

}  // namespace compueye::firmware
