#pragma once

#include "recon/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

struct SingularValue {
  double value = 0.0;  ///< a lower bound that grows with every iteration
  int iterations = 0;
  bool settled = false;  ///< the last iteration changed it by less than 1e-9 of itself
};

/// The largest singular value of A, which is the norm of A and the square root of the gradient's Lipschitz constant:
/// power iteration on A'A from a fixed start, at most 300 times (Golub & Van Loan, "Matrix Computations", 4th
/// ed., 8.2.1). `progress` may stop it early, not settled.
[[nodiscard]] SingularValue largest_singular_value(const recon::Response& a, const recon::Progress& progress);

}  // namespace compueye::firmware
