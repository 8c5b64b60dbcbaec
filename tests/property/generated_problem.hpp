#pragma once

#include <rapidcheck.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "studies/stability/hard_case.hpp"

namespace compueye::tests {

/// The same draws in every run; RC_PARAMS says otherwise ("seed=2 max_success=10000", or the "reproduce=..." that a
/// failure prints).
struct UsualDraws {
  UsualDraws() { setenv("RC_PARAMS", "seed=20161128 max_success=200", 0); }
};
inline const UsualDraws usual_draws;

/// Whole numbers from -most to most over 8, so that what a failure shrinks to, nought first, can be read.
inline std::vector<double> eighths(std::size_t count, int most = 8) {
  const auto drawn = *rc::gen::container<std::vector<int>>(count, rc::gen::inRange(0, 2 * most + 1));
  std::vector<double> values;
  for (const int k : drawn) values.push_back((k % 2 == 0 ? -k / 2 : (k + 1) / 2) / 8.0);
  return values;
}

inline std::vector<float> narrowed(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

/// A matrix of a small picture, never all nought; sparse or dense.
inline recon::Response some_response() {
  const int rows = *rc::gen::inRange(1, 12), high = *rc::gen::inRange(1, 7), wide = *rc::gen::inRange(1, 7);
  const auto cols = static_cast<std::size_t>(high * wide);
  std::vector<double> values = eighths(static_cast<std::size_t>(rows) * cols);
  if (*rc::gen::arbitrary<bool>()) {  // as an eye's: nothing below nought
    for (double& value : values) value = std::abs(value);
  }
  values[0] += values[0] == 0.0 ? 1.0 : 0.0;
  return recon::Response::from_dense(rows, static_cast<int>(cols), std::move(values))
      .value()
      .with_image(high, wide)
      .value();
}

/// Samples of such a matrix, some of them without a weight.
inline firmware::HardProblem some_problem() {
  firmware::HardProblem problem{some_response(), {}, {}, {}, 1.0};
  problem.y = narrowed(eighths(static_cast<std::size_t>(problem.a.rows()), 32));
  const auto weights = *rc::gen::container<std::vector<int>>(problem.y.size(), rc::gen::inRange(0, 9));
  for (const int weight : weights) problem.weights.push_back(weight == 0 ? 1.0F : static_cast<float>(weight) / 8.0F);
  return problem;
}

}  // namespace compueye::tests
