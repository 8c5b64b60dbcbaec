#include "recon/setup/step_rounding.hpp"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace compueye::recon {
namespace {

/// F^(-1/2) (F_stored - F) F^(-1/2) as Spectra takes a matrix.
class RelativeError {
 public:
  using Scalar = double;

  explicit RelativeError(const RoundedStep& step)
      : step_(step),
        change_(step.gains.array() - step.rest),
        growth_((step.rest / step.gains.array()).sqrt() - 1.0),
        scale_(1.0 / std::sqrt(step.rest)) {}

  [[nodiscard]] Eigen::Index rows() const { return step_.exact.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return step_.exact.rows(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) = apply(Eigen::Map<const Eigen::VectorXd>(in, rows()));
  }
  [[nodiscard]] Eigen::VectorXd apply(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd scaled = rooted(x);
    const Eigen::VectorXd off =
        step_.stored * (change_.array() * (step_.stored.transpose() * scaled).array()).matrix() -
        step_.exact * (change_.array() * (step_.exact.transpose() * scaled).array()).matrix();
    return rooted(off);
  }

 private:
  [[nodiscard]] Eigen::VectorXd rooted(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd along = (growth_.array() * (step_.exact.transpose() * x).array()).matrix();
    return scale_ * (x + step_.exact * along);
  }

  const RoundedStep& step_;
  Eigen::VectorXd change_, growth_;
  double scale_;
};

constexpr Eigen::Index whole_below = 64;

double of_whole(const RelativeError& error) {
  const Eigen::Index order = error.rows();
  Eigen::MatrixXd matrix(order, order);
  for (Eigen::Index k = 0; k < order; ++k) matrix.col(k) = error.apply(Eigen::VectorXd::Unit(order, k));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseAbs().maxCoeff();
}

/// 2 ||F^(-1/2) E D U' F^(-1/2)|| + ||F^(-1/2) E D^(1/2)||^2 with Frobenius's norm, where E is the rounding and D = f_0
/// - f: a bound that needs no iteration.
double bound(const RoundedStep& step) {
  const Eigen::MatrixXd along = step.exact.transpose() * (step.stored - step.exact);
  const Eigen::ArrayXd growth = step.rest / step.gains.array() - 1.0;
  double crossed = 0.0, squared = 0.0;
  for (Eigen::Index k = 0; k < step.gains.size(); ++k) {
    const double size =
        ((step.stored.col(k) - step.exact.col(k)).squaredNorm() + (growth * along.col(k).array().square()).sum()) /
        step.rest;
    const double drop = step.rest - step.gains[k];
    crossed += size * drop * drop / step.gains[k];
    squared += size * drop;
  }
  return 2.0 * std::sqrt(crossed) + squared;
}

}  // namespace

double rounding(const RoundedStep& step) {
  if (step.gains.size() == 0) return 0.0;
  const double most = bound(step);
  if (!(most > 0.0)) return 0.0;  // nothing to iterate on: vectors that are stored as they are
  const RelativeError error(step);
  if (error.rows() <= whole_below) return of_whole(error);
  constexpr Eigen::Index krylov = 40;
  constexpr int most_restarts = 10;
  constexpr double tolerance = 0.02, margin = 1.05;
  Spectra::SymEigsSolver<RelativeError> solver(const_cast<RelativeError&>(error), 1, krylov);
  solver.init();
  if (solver.compute(Spectra::SortRule::LargestMagn, most_restarts, tolerance) < 1) return most;
  return std::min(margin * std::abs(solver.eigenvalues()[0]), most);
}

}  // namespace compueye::recon
