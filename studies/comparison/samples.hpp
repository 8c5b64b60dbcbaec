#pragma once

#include <optional>
#include <vector>

#include "firmware/eye/board.hpp"
#include "firmware/eye/ready_eye.hpp"
#include "hal/image.hpp"
#include "hal/result.hpp"
#include "recon/setup/factor.hpp"
#include "studies/comparison/comparison.hpp"

namespace compueye::firmware {

/// One frame that every solver gets, and the truth behind it.
struct CompareSamples {
  std::string scene;
  hal::Image truth;
  LivingResponse living;
  std::vector<float> y;  ///< M
  std::vector<float> weights;
  std::optional<hal::Image> conventional;  ///< what the conventional eye shows; none for a lattice that has none
};

/// Errors: those of the scene, the response file (and mismatch when it is another eye's), living_response() and the
/// simulated eye; interrupted.
[[nodiscard]] hal::Result<CompareSamples> take_samples(const Board& board, const CompareOptions& options,
                                                       const recon::Progress& progress);

}  // namespace compueye::firmware
