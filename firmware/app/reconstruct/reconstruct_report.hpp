#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/reconstruct/frame_loop.hpp"
#include "firmware/app/reconstruct/reconstruct_options.hpp"
#include "firmware/app/report/json_report.hpp"

namespace compueye::firmware {

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

[[nodiscard]] std::string report_text(const ReconstructReport& report);
[[nodiscard]] Json report_json(const ReconstructReport& report);

}  // namespace compueye::firmware
