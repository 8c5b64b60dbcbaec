#pragma once

#include <Eigen/Core>

namespace compueye::recon::reference {

/// min 1/2 z'Pz + q'z  subject to  G z <= h, all dense and in double.
struct QuadraticProgram {
  Eigen::MatrixXd p;  ///< symmetric positive semidefinite
  Eigen::VectorXd q;
  Eigen::MatrixXd g;
  Eigen::VectorXd h;
};

struct QuadraticSolution {
  Eigen::VectorXd z;
  double objective = 0.0;
  double gap = 0.0;  ///< complementarity s'mu: bounds the distance to the optimum once the residuals vanish
  int iterations = 0;
  bool converged = false;
};

/// Mehrotra's predictor-corrector (Nocedal & Wright, "Numerical Optimization", 2nd ed., algorithm 16.4), until the gap
/// and both residuals are below `tolerance` of the problem's scale. Slow and accurate: a judge, not a product.
[[nodiscard]] QuadraticSolution solve_interior_point(const QuadraticProgram& qp, double tolerance = 1e-11,
                                                     int max_iterations = 200);

}  // namespace compueye::recon::reference
