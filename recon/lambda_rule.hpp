#pragma once

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// lambda from the noise: `sigma` is the standard deviation of one sample, in units of y (one fully seen white pixel).
///
///   l1, omp:         lambda = c sigma median_j ||A psi_j||_2, psi_j the elements of the basis
///   tikhonov, tsvd:  lambda = (sigma / s)^2, s the standard deviation expected of a pixel
///
/// The first is the universal choice for the lasso, sigma ||a_j|| sqrt(2 log N) (Bickel, Ritov & Tsybakov 2009,
/// "Simultaneous analysis of Lasso and Dantzig selector", eq. 4.1), with the columns of very different length that a
/// basis gives represented by their median, and a factor c below sqrt(2 log N) because overlapping receptive fields
/// correlate the columns (Hebiri & Lederer 2013, "How correlations influence lasso prediction"). c was fitted on tuning
/// scenes; docs/lambda-rule.md shows how far the rule lands from the best lambda on scenes it has not seen.
/// The second is the posterior mean under a Gaussian prior.
///
/// Without noise, or for an A that sees nothing, a millionth of the norms keeps lambda above zero.
/// Error: out_of_range when sigma is negative or not finite.
[[nodiscard]] hal::Result<double> lambda_by_rule(const Response& response, int image_rows, int image_cols,
                                                 SolverKind solver, BasisKind basis, double sigma);

/// The same from median_atom_norm(), which for a large eye is worth keeping: finding it takes seconds.
[[nodiscard]] hal::Result<double> lambda_by_rule(double atom_norm, SolverKind solver, BasisKind basis, double sigma);

/// median_j ||A psi_j||_2 over all N elements of the basis.
[[nodiscard]] double median_atom_norm(const Response& response, int image_rows, int image_cols, BasisKind basis);

}  // namespace compueye::recon
