#pragma once

#include <optional>
#include <span>
#include <vector>

#include "studies/stability/hard_case.hpp"

namespace compueye::firmware {

/// What pictures of one problem are worth, in double and apart from any solver's own arithmetic, and how low the
/// optimum can lie at least.
class OptimumBound {
 public:
  OptimumBound(const HardProblem& problem, const recon::Objective& objective);

  /// 1/2 ||W^(1/2)(Ax-y)||^2 + lambda ||Psi x||_1 over seeing channels.
  [[nodiscard]] double objective(std::span<const float> x) const;

  /// Runs every solver that minimises in double, `iterations` and then ten times as many, until one proves by its
  /// duality gap that it is within 1e-6: the largest objective less gap. Nothing: none could say.
  void prove(int iterations);

  [[nodiscard]] std::optional<double> bound() const noexcept { return bound_; }

 private:
  const HardProblem& problem_;
  recon::Objective objective_;
  std::optional<double> bound_;
};

}  // namespace compueye::firmware
