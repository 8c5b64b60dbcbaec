#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/operating_points/machine.hpp"
#include "firmware/operating_points/measured_point.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"
#include "studies/accuracy_and_time/evaluation_scenes.hpp"
#include "studies/accuracy_and_time/pareto_options.hpp"

namespace compueye::firmware {

/// Every point of a board on this machine.
struct Sweep {
  std::string board;
  std::uint64_t response_hash = 0;
  Machine machine;
  recon::ConstraintKind constraint = recon::ConstraintKind::none;  ///< the board's
  double lo = 0.0, hi = 1.0;
  int channels = 0, seeing = 0, image_rows = 0, image_cols = 0;
  std::vector<std::string> scenes;  ///< names, in the order in which they take turns
  std::vector<NoiseLevel> levels;
  std::vector<QualitySummary> conventional;  ///< by level; empty for a lattice that has none
  std::vector<MeasuredPoint> points;
  std::size_t planned = 0;       ///< points of the table, those included that were left out for a reason
  double processor_share = 1.0;  ///< processor time over wall time of the timed frames; below one when disturbed
  std::string cut_short;         ///< why points of the table are missing that should not be; empty: none are
  std::vector<std::string> notes;
};

/// Measures everything: pictures of every scene at every noise level, some timed frames of every point, and then many
/// of the efficient ones. A stop or the end of the budget keeps what is done. Errors: when there is no point at all.
[[nodiscard]] hal::Result<Sweep> sweep(const Board& board, const ParetoOptions& options, const hal::Clock& clock,
                                       const recon::Progress& progress);

/// The points that no other outdoes in median time and, by more than a hundredth, in mean NMSE at `level`
/// (sweep.levels.size(): overall), by time.
/// A warm start on a still scene is none of them: it is the best that can happen, not what can be counted on.
[[nodiscard]] std::vector<std::size_t> efficient_points(const Sweep& sweep, std::size_t level);

}  // namespace compueye::firmware
