#pragma once

#include <optional>
#include <span>
#include <vector>

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// One lambda and the risk estimated at it.
struct LambdaTrial {
  double lambda = 0.0;
  double risk = 0.0;
};

struct LambdaByRisk {
  double lambda = 0.0;
  std::vector<LambdaTrial> trials;  ///< the first is at the start
  std::optional<Factor> factor;     ///< of admm in single precision, for Reconstructor::create()
};

/// A lambda from the samples of one frame, to be kept for those that follow: of `objective.lambda` (by rule, say) and
/// 1/4, 4, 16, 64 and 256 times that, the one with the least estimated risk E||A(x - x0)||^2 (Stein 1981, "Estimation
/// of the mean of a multivariate normal distribution"):
///
///     risk = ||y - A x(y)||^2 - M sigma^2 + 2 sigma^2 b'(A x(y + e b) - A x(y)) / e
///
/// with b of random signs, which makes the solver a black box (Ramani, Blu & Unser 2008, "Monte-Carlo SURE"). The start
/// stands unless the risk falls by more than two standard errors of the samples' noise, 2 sigma^2 sqrt(M): an eye of
/// few ommatidia cannot tell lambdas apart, and then the rule is the better judge.
///
/// Costs twelve frames. `y` has all of the response's channels, none of them
/// missing; `sigma` is the standard deviation of one sample. Without noise the start stands. The same input gives the
/// same lambda. Errors: those of Reconstructor::create(); mismatch (number of samples); out_of_range (sigma negative or
/// not finite, or samples that cannot be solved). `factor` as for Reconstructor::create(),
/// for admm in single precision.
[[nodiscard]] hal::Result<LambdaByRisk> lambda_by_risk(const Response& response, const Objective& objective,
                                                       const Plan& plan, std::span<const float> y, double sigma,
                                                       std::optional<Factor> factor = std::nullopt,
                                                       const Progress& progress = {});

}  // namespace compueye::recon
