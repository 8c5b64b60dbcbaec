#pragma once

#include <optional>
#include <vector>

#include "bench/lambda_rule/cases.hpp"
#include "recon/response.hpp"

namespace compueye::bench {

/// What a second solve of the same frame can make of a pixel-sparse picture, with columns of the response scaled so
/// that the solver as it is does it. Not in the product; docs/lambda-rule.md has the figures.

/// Least squares within the constraint on the pixels above a tenth of white.
[[nodiscard]] std::vector<float> debiased(const Case& c, const recon::Response& response, const std::vector<float>& y,
                                          const std::vector<float>& x);

/// One pass of reweighted l1, weights e / (x_j + e) with e a tenth of white (Candes, Wakin & Boyd 2008, "Enhancing
/// sparsity by reweighted l1 minimization"), x >= 0, clipped to white at the end.
[[nodiscard]] std::vector<float> reweighted(const Case& c, const recon::Response& response, const std::vector<float>& y,
                                            const std::vector<float>& x, double lambda);

/// One frame at lambda, set up and solved.
[[nodiscard]] std::vector<float> solved(const Case& c, const recon::Response& response,
                                        const recon::Objective& objective, const std::vector<float>& y,
                                        std::optional<recon::Factor>& factor);

}  // namespace compueye::bench
