#pragma once

#include "bench/lambda_rule/cases.hpp"

namespace compueye::bench {

/// Every scene at every signal-to-noise ratio (rms of the samples without noise over sigma) of a family case, a line a
/// lambda, with what a choice of lambda could go by: case, scene, seed, dB, sigma, rms of the samples, lambda, NMSE,
/// misfit ||Ax - y||^2 / (M sigma^2), degrees of freedom over M, ||Psi x||_1, the residual's colour. Tuning seeds and
/// ratios.
void print_family_points(const Case& c);

/// One line a case: how far lambda by rule and from the samples land from the best lambda of a sweep, and what the
/// search costs beside the set-up. Evaluation seeds and ratios.
void print_family_scores(const Case& c, bool each);
void print_family_head();

}  // namespace compueye::bench
