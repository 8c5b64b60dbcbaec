#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/app/commands/reconstruct_options.hpp"
#include "firmware/app/report.hpp"
#include "firmware/eye/picture_quality.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// What one frame came to.
struct FrameRecord {
  recon::FrameInfo info;
  double solve_ms = 0.0;
  std::optional<PictureQuality> quality;  ///< with a truth only
};

/// Everything that `compueye reconstruct` tells of a run.
struct ReconstructReport {
  ReconstructOptions options;
  recon::Objective objective;
  recon::Plan plan;  ///< every rule resolved
  recon::OperatingPoint point;
  std::int64_t frames = 0;
  int channels = 0;
  int seeing_channels = 0;
  PictureSize size;
  std::uint64_t table_bytes = 0;
  std::uint64_t workspace_bytes = 0;
  double setup_s = 0.0;
  std::vector<FrameRecord> records;  ///< one a frame, at least one
};

[[nodiscard]] Figures report_figures(const ReconstructReport& report);

}  // namespace compueye::firmware
