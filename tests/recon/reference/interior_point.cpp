#include "tests/recon/reference/interior_point.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace compueye::recon::reference {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

struct Iterate {
  Vector z, s, mu;
};

struct Residuals {
  Vector dual, primal;
};

/// Largest step in (0, 1] that keeps `value + step * change` positive.
double step_to_boundary(const Vector& value, const Vector& change) {
  double step = 1.0;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    if (change[i] < 0.0) step = std::min(step, -value[i] / change[i]);
  }
  return step;
}

/// P + G' diag(mu / s) G with its factor; near the solution it is so ill-conditioned that a solve needs refinement.
struct NormalEquations {
  NormalEquations(const QuadraticProgram& qp, const Iterate& at, double regularisation)
      : matrix(qp.p + qp.g.transpose() * (at.mu.array() / at.s.array()).matrix().asDiagonal() * qp.g) {
    Matrix regular = matrix;
    regular.diagonal().array() += regularisation;
    factor.compute(regular);
  }

  [[nodiscard]] Vector solve(const Vector& b) const {
    Vector x = factor.solve(b);
    for (int k = 0; k < 3; ++k) x += factor.solve(b - matrix * x);
    return x;
  }

  Matrix matrix;
  Eigen::LDLT<Matrix> factor;
};

Residuals residuals(const QuadraticProgram& qp, const Iterate& at) {
  return {qp.p * at.z + qp.q + qp.g.transpose() * at.mu, qp.g * at.z + at.s - qp.h};
}

/// The Newton direction whose complementarity products become `target` - s.mu.
Iterate direction(const QuadraticProgram& qp, const NormalEquations& normal, const Iterate& at, const Residuals& r,
                  const Vector& target) {
  const Vector complement = (at.s.array() * at.mu.array() - target.array()).matrix();
  const Vector scaled = ((at.mu.array() * r.primal.array() - complement.array()) / at.s.array()).matrix();
  Iterate d;
  d.z = normal.solve(-r.dual - qp.g.transpose() * scaled);
  d.s = -r.primal - qp.g * d.z;
  d.mu = ((-complement.array() - at.mu.array() * d.s.array()) / at.s.array()).matrix();
  return d;
}

}  // namespace

QuadraticSolution solve_interior_point(const QuadraticProgram& qp, double tolerance, int max_iterations) {
  const Eigen::Index inequalities = qp.g.rows();
  Iterate at{Vector::Zero(qp.q.size()), Vector::Ones(inequalities), Vector::Ones(inequalities)};
  at.s = (qp.h - qp.g * at.z).cwiseMax(1.0);
  const double scale = 1.0 + qp.q.cwiseAbs().maxCoeff() + (inequalities > 0 ? qp.h.cwiseAbs().maxCoeff() : 0.0);
  QuadraticSolution solution;
  for (int k = 0; k < max_iterations; ++k) {
    const Residuals r = residuals(qp, at);
    solution.gap = at.s.dot(at.mu);
    solution.iterations = k;
    solution.converged = solution.gap < tolerance * scale && r.dual.cwiseAbs().maxCoeff() < tolerance * scale &&
                         r.primal.cwiseAbs().maxCoeff() < tolerance * scale;
    if (solution.converged) break;
    const NormalEquations normal(qp, at, 1e-13 * scale);
    const double mean = solution.gap / static_cast<double>(inequalities);
    const Iterate affine = direction(qp, normal, at, r, Vector::Zero(inequalities));
    const double affine_step = std::min(step_to_boundary(at.s, affine.s), step_to_boundary(at.mu, affine.mu));
    const double affine_mean =
        (at.s + affine_step * affine.s).dot(at.mu + affine_step * affine.mu) / static_cast<double>(inequalities);
    const double centring = (affine_mean / mean) * (affine_mean / mean) * (affine_mean / mean);
    // Products far below the wanted gap would only spoil the condition of the next step.
    const double lowest = 0.1 * tolerance * scale / static_cast<double>(inequalities);
    const Vector target =
        Vector::Constant(inequalities, std::max(centring * mean, lowest)) - affine.s.cwiseProduct(affine.mu);
    const Iterate d = direction(qp, normal, at, r, target);
    const double step = std::min(1.0, 0.995 * std::min(step_to_boundary(at.s, d.s), step_to_boundary(at.mu, d.mu)));
    at.z += step * d.z;
    at.s += step * d.s;
    at.mu += step * d.mu;
  }
  solution.z = at.z;
  solution.objective = 0.5 * at.z.dot(qp.p * at.z) + qp.q.dot(at.z);
  return solution;
}

}  // namespace compueye::recon::reference
