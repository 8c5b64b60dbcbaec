#pragma once

#include <optional>
#include <vector>

#include "bench/lambda_rule/cases.hpp"
#include "recon/problem/response.hpp"

namespace compueye::bench {

/// Least squares within the constraint on the pixels above a tenth of white. Not in the product; docs/lambda-rule.md
/// compares it with what is.
[[nodiscard]] std::vector<float> debiased(const Case& c, const recon::Response& response, const std::vector<float>& y,
                                          const std::vector<float>& x);

/// The product's second pass, Plan::l1_reweighting at a tenth of white.
[[nodiscard]] std::vector<float> reweighted(const Case& c, const recon::Response& response, const std::vector<float>& y,
                                            const recon::Objective& objective, std::optional<recon::Factor>& factor);

/// One frame at lambda, set up and solved.
[[nodiscard]] std::vector<float> solved(const Case& c, const recon::Response& response,
                                        const recon::Objective& objective, const std::vector<float>& y,
                                        std::optional<recon::Factor>& factor, double l1_reweighting = 0.0);

}  // namespace compueye::bench
