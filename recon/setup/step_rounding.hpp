#pragma once

#include <Eigen/Core>

namespace compueye::recon {

/// The dual step F = f_0 I + U diag(f_k - f_0) U' of one class (core/parts/deflated_step.hpp), and U as it is stored.
struct RoundedStep {
  Eigen::MatrixXd exact;   ///< order x count, columns orthonormal
  Eigen::MatrixXd stored;  ///< the same, rounded
  Eigen::VectorXd gains;   ///< f_k, positive
  double rest = 1.0;       ///< f_0 >= f_k
};

/// How far rounding has moved F in its own metric: the largest |eigenvalue| e of F^(-1/2) (F_stored - F) F^(-1/2), so
/// that (1 - e) F <= F_stored <= (1 + e) F for every dual. Never less than that by more than one part in twenty, with a
/// probability of failure below 1e-6 (Kuczynski & Wozniakowski 1992, theorem 4.2).
[[nodiscard]] double rounding(const RoundedStep& step);

}  // namespace compueye::recon
