#pragma once

#include <vector>

#include "bench/lambda_rule/sweep.hpp"

namespace compueye::bench {

/// Median and worst of NMSE / best NMSE at every multiple of the rule's lambda: where the rule's factors come from.
void print_tuning(const Case& c, const std::vector<Sweep>& sweeps);

/// How far the rule, and lambda by risk, land from the best lambda: a line a scene when asked, a line a case.
void print_evaluation(const Case& c, const std::vector<Sweep>& sweeps, bool each);

/// For pixels: what a second pass makes of the rule's picture, per noise level.
void print_second_passes(const Case& c, const std::vector<Sweep>& sweeps);

/// What the columns of the lines a case mean.
void print_evaluation_head();

}  // namespace compueye::bench
