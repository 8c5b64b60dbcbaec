#pragma once

#include <vector>

#include "calib/estimate/estimate.hpp"
#include "recon/problem/response.hpp"
#include "sim/effects/circumstances.hpp"
#include "tests/calib/estimate/built_eye.hpp"

namespace compueye::test {

/// Standard deviation of every channel's sample of a sparse scene: read noise and rounding, and what the sigmas of its
/// row make of such a scene.
[[nodiscard]] std::vector<double> sample_sigmas(const calib::ResponseEstimate& estimate,
                                                const sim::EyeToSimulate& board);

/// NMSE of the pictures that `response` reconstructs of `scenes` sparse ones (ten lit pixels each), median: admm in the
/// pixels' own basis, 0 .. 1, 1000 iterations, rows and samples over `sigmas` (a channel each), lambda by rule. Samples
/// are the codes of the board's sensor less the dark level.
[[nodiscard]] hal::Result<double> median_nmse(const recon::Response& response, const std::vector<double>& sigmas,
                                              const sim::EyeToSimulate& board, const PixelResponses& eye, int scenes);

/// The true rows as a response.
[[nodiscard]] hal::Result<recon::Response> true_response(const sim::EyeToSimulate& board, const PixelResponses& eye);

}  // namespace compueye::test
