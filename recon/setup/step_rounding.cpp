#include "recon/setup/step_rounding.hpp"

#include <algorithm>
#include <cmath>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {
namespace {

/// F^(-1/2) (F_stored - F) F^(-1/2).
class RelativeError {
 public:
  explicit RelativeError(const RoundedStep& step)
      : step_(step),
        change_(step.gains.array() - step.rest),
        growth_((step.rest / step.gains.array()).sqrt() - 1.0),
        scale_(1.0 / std::sqrt(step.rest)) {}

  [[nodiscard]] Eigen::Index rows() const { return step_.exact.rows(); }
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

constexpr Eigen::Index exact_below = 64;

double of_whole(const RelativeError& error) {
  const Eigen::Index order = error.rows();
  Eigen::MatrixXd matrix(order, order);
  for (Eigen::Index k = 0; k < order; ++k) matrix.col(k) = error.apply(Eigen::VectorXd::Unit(order, k));
  return symmetric_values(matrix).cwiseAbs().maxCoeff();
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
  if (error.rows() <= exact_below) return of_whole(error);
  const SymmetricProduct product = [&](const double* in, double* out) {
    Eigen::Map<Eigen::VectorXd>(out, error.rows()) = error.apply(Eigen::Map<const Eigen::VectorXd>(in, error.rows()));
  };
  constexpr double margin = 1.05;
  const auto largest = largest_magnitude(error.rows(), product, {.krylov = 40, .restarts = 10, .tolerance = 0.02});
  return largest ? std::min(margin * std::abs(*largest), most) : most;
}

}  // namespace compueye::recon
