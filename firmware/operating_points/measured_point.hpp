#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "studies/accuracy_and_time/quality_summary.hpp"
#include "studies/accuracy_and_time/sweep_table.hpp"

namespace compueye::firmware {

/// What a point is worth at one noise level.
struct LevelFigures {
  double times = 0.0;  ///< the board's own noise
  double sigma = 0.0;
  double lambda = 0.0;  ///< by rule
  QualitySummary quality;
};

/// One way of turning y into x, what it is worth and what it costs on this machine.
struct MeasuredPoint {
  Curve curve;
  recon::OperatorKind op = recon::OperatorKind::csr;
  int iterations = 0;
  std::vector<LevelFigures> levels;  ///< the board's own noise first
  QualitySummary overall;            ///< over scenes and levels
  double objective = 0.0;            ///< mean over the scenes of the first level
  double median_ms = 0.0;
  double p999_ms = 0.0;  ///< 99.9th percentile; of fewer than 1000 frames the slowest
  std::uint64_t timed_frames = 0;
  std::uint64_t table_bytes = 0;
  std::uint64_t workspace_bytes = 0;
};

}  // namespace compueye::firmware
