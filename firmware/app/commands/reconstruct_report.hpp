#pragma once

#include <optional>
#include <span>

#include "firmware/app/commands/reconstruct_options.hpp"
#include "firmware/eye/measured_eye.hpp"
#include "firmware/eye/picture_quality.hpp"
#include "firmware/text/figures.hpp"
#include "recon/reconstructor.hpp"
#include "recon/response_fit.hpp"

namespace compueye::firmware {

/// What one frame came to.
struct FrameRecord {
  recon::FrameInfo info;
  double solve_ms = 0.0;
  std::optional<recon::ResponseFit> fit;  ///< with a sigma only
  std::int64_t clipped_pixels = 0;        ///< in its PNG
  std::optional<PictureQuality> quality;  ///< with a truth only
};

/// Everything that `compueye reconstruct` tells of a run: of `frames`, whose records they are (at least one that is not
/// invalid), with every rule that `reconstructor` resolved. `sigma`: what lambda is from, if not by hand. `measured`:
/// null unless the response is from an eye file.
[[nodiscard]] Figures figures_of(const ReconstructOptions& options, const MeasuredEye* measured,
                                 std::optional<double> sigma, const recon::Reconstructor& reconstructor, double setup_s,
                                 std::span<const FrameRecord> frames);

}  // namespace compueye::firmware
