#pragma once

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// The ADMM penalty rho of a plan: plan.rho when given; lambda for tikhonov; otherwise .06 ||A||_F^2 / N, a fixed share
/// of the mean squared norm of A's columns.
///
/// The best rho follows the curvature of the data term, not lambda, so one factor serves every lambda and noise level.
/// The share was found on the 8x8 eye (pixels, 30 to 50 dB) and the 80x80 eye (DCT and box, 58 dB): a tenth or ten
/// times of it costs two to five times the iterations. It scales as A does, and not at all with the unit of x.
[[nodiscard]] double resolve_rho(const Response& response, const Objective& objective, const Plan& plan);

}  // namespace compueye::recon
