#pragma once

#include <optional>
#include <vector>

#include "firmware/app/reconstruct/frame_inputs.hpp"
#include "firmware/app/reconstruct/frame_quality.hpp"
#include "firmware/app/reconstruct/picture_outputs.hpp"
#include "firmware/app/session.hpp"
#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::firmware {

/// What one frame came to.
struct FrameRecord {
  recon::FrameInfo info;
  double solve_ms = 0.0;
  std::optional<FrameQuality> quality;  ///< with a truth only
};

/// Solves every frame in order and hands the pictures to `outputs`. Errors: interrupted; out_of_range when a frame's
/// numbers leave the range of the precision, named by frame; those of `outputs`.
[[nodiscard]] hal::Result<std::vector<FrameRecord>> reconstruct_frames(const recon::Reconstructor& reconstructor,
                                                                       const FrameInputs& inputs, const Truth* truth,
                                                                       PictureOutputs& outputs, Session& session);

}  // namespace compueye::firmware
