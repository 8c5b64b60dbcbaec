#pragma once

#include <span>

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// lambda from the noise: `sigma` is the standard deviation of one sample, in units of y (one fully seen white pixel).
///
///   identity:        lambda = 1.1 sigma median_j ||a_j||_2,   a_j the columns of A
///   other bases:     lambda = 0.002 sigma mean_j ||a_j||_1
///   omp:             lambda = c sigma median_j ||A psi_j||_2,  psi_j the elements of the basis, c = 1.1 or 0.4
///   tikhonov, tsvd:  lambda = (sigma / 0.35)^2
///
/// The first is the universal choice for the lasso, sigma ||a_j|| sqrt(2 log N) (Bickel, Ritov & Tsybakov 2009,
/// "Simultaneous analysis of Lasso and Dantzig selector", eq. 4.1), with a factor below sqrt(2 log N) because
/// overlapping receptive fields correlate the columns (Hebiri & Lederer 2013, "How correlations influence lasso
/// prediction"). The second knows nothing of sparsity: mean_j ||a_j||_1 is how many ommatidia see a pixel, and sigma
/// times it bounds |A'n| for noise of size sigma that is the same in all of them; shrinking by two thousandths of that
/// settles the directions in which a constrained least-squares picture is not determined. omp stops by the
/// correlation with an atom, so its rule keeps the norms of atoms. The last is the posterior
/// mean under a Gaussian prior of standard deviation .35. Both factors were fitted on tuning scenes;
/// docs/lambda-rule.md shows how far the rule lands from the best lambda on scenes it has not seen, and
/// recon/lambda_by_risk.hpp improves on it from a frame's samples.
///
/// All scale with y and A as lambda does. Without noise, or for an A that sees nothing, a millionth of the scale keeps
/// lambda above zero. `white` is how bright a white pixel is in x's unit: the prior's .35 and the millionth are shares
/// of it. Errors: out_of_range when sigma is negative or not finite, mismatch for omp in a basis when the response does
/// not know its picture.
[[nodiscard]] hal::Result<double> lambda_by_rule(const Response& response, SolverKind solver, BasisKind basis,
                                                 double sigma, double white = 1.0);

/// 1, unless samples are so far from what white pixels read that their unit must be another: then ||y|| over what white
/// would read, of channels in use (`weights` empty: all). Below 2^-12 or above 8.
[[nodiscard]] double white_of_samples(const Response& response, std::span<const float> y,
                                      std::span<const float> weights);

/// What the rule for l1 takes from the response: median_j ||a_j||_2 for the identity, mean_j ||a_j||_1 for other bases.
/// Over all N columns, those that nobody sees included.
[[nodiscard]] double lambda_scale(const Response& response, BasisKind basis);

}  // namespace compueye::recon
