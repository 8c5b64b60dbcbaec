#pragma once

#include <optional>
#include <span>
#include <vector>

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// The frame that lambda is chosen by: y and weights as for Reconstructor::solve(), `sigma` the standard deviation of
/// one sample of weight one.
struct NoisyFrame {
  std::span<const float> y;
  std::span<const float> weights;
  double sigma = 0.0;
};

/// One lambda and what the frame says of it, all in squares of y's unit.
struct LambdaTrial {
  double lambda = 0.0;
  double risk = 0.0;      ///< estimate of ||W^(1/2) A(x - x0)||^2
  double surprise = 0.0;  ///< what decides where risks are too close to tell
  double misfit = 0.0;    ///< ||W^(1/2)(Ax - y)||^2
};

struct LambdaByRisk {
  double lambda = 0.0;
  double unexplained = 0.0;         ///< where the start stands because the choice left so many times what noise does
  std::vector<LambdaTrial> trials;  ///< the first is at the start
  std::optional<Factor> factor;     ///< of admm in single precision, for Reconstructor::create()
};

/// A lambda from the samples of one frame, to be kept for those that follow. Tried are `objective.lambda` (by rule,
/// say) and its multiples by powers of four, from 1/64 up to where nothing is left of the picture, then half and twice
/// the best of these; none below the start where frames are warm or of fewer than a hundred iterations, which do not
/// get to the picture of a lower lambda. With M channels of a weight above zero, Stein's unbiased estimate of the
/// samples' risk (Stein 1981, "Estimation of the mean of a multivariate normal distribution") is
///
///     risk = ||y - A x(y)||^2 - M sigma^2 + 2 sigma^2 b'(A x(y + e b) - A x(y)) / e
///
/// with b of random signs, which makes the solver a black box (Ramani, Blu & Unser 2008, "Monte-Carlo SURE"). It says
/// little of directions that the eye hardly sees, and of few ommatidia it is mostly noise. So of all lambdas within
/// one standard error sigma^2 sqrt(M) of the least risk that one is taken whose picture surprises least, by
///
///     surprise = ||y - A x||^2 + 2 lambda ||Psi x||_1 - 2 * 0.3 M sigma^2 log lambda,
///
/// 2 sigma^2 times -log of the density of y and x where Psi x is Laplacian with 0.3 M coefficients that count (Pereyra,
/// Bioucas-Dias & Figueiredo 2015, "Maximum-a-posteriori estimation with unknown regularisation parameters"). Both
/// numbers were chosen on tuning scenes (docs/lambda-rule.md). Where lambda is not the weight of an l1 term, and with
/// a second pass, the risk decides alone. Where even the choice leaves more than twice the squares that noise does, the
/// samples tell of something else (iterations that are too few, a response that is another eye's), and the start
/// stands.
///
/// Costs up to thirty cold frames, of sixty iterations or more where the plan starts warm. Without noise the start
/// stands. The same input gives the same lambda; y and sigma times a power of two give lambda times that. Errors: those
/// of Reconstructor::create() at the start; mismatch (number of samples or weights); out_of_range (sigma negative or
/// not finite, or samples that cannot be solved). `factor` as for Reconstructor::create(), for admm in single
/// precision.
[[nodiscard]] hal::Result<LambdaByRisk> lambda_by_risk(const Response& response, const Objective& objective,
                                                       const Plan& plan, const NoisyFrame& frame,
                                                       std::optional<Factor> factor = std::nullopt,
                                                       const Progress& progress = {});

}  // namespace compueye::recon
