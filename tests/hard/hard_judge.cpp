#include "tests/hard/hard_judge.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "recon/solver_list.hpp"
#include "tests/recon/dense_matrix.hpp"
#include "tests/recon/reference/dense_algebra.hpp"
#include "tests/recon/reference/reference_solver.hpp"

namespace compueye::tests {
namespace {

int exponent_of(double size) {
  return size > 0.0 && std::isfinite(size) ? std::ilogb(size) : 0;
}

recon::Response times_power(const recon::Response& a, int exponent) {
  std::vector<double> values(a.values().begin(), a.values().end());
  for (double& value : values) value = std::ldexp(value, exponent);
  const std::vector<std::int64_t> start(a.row_start().begin(), a.row_start().end());
  const std::vector<std::int32_t> columns(a.columns().begin(), a.columns().end());
  auto made = a.is_dense() ? recon::Response::from_dense(a.rows(), a.cols(), values)
                           : recon::Response::from_csr(a.rows(), a.cols(), start, columns, values);
  return std::move(made).value().with_image(a.image_rows(), a.image_cols()).value();
}

}  // namespace

HardJudge::HardJudge(const firmware::HardProblem& problem)
    : in_unit_(problem), exponent_a_(-exponent_of(std::sqrt(problem.a.squared_norm() / problem.a.cols()))) {
  in_unit_.a = times_power(problem.a, exponent_a_);
  a_ = dense_matrix(in_unit_.a);
  double squares = 0.0;
  int counted = 0;
  for (std::size_t m = 0; m < problem.y.size(); ++m) {
    w_.push_back(problem.weights.empty() ? 1.0 : static_cast<double>(problem.weights[m]));
    y_.push_back(w_.back() > 0.0 ? static_cast<double>(problem.y[m]) : 0.0);
    squares += y_.back() * y_.back();
    counted += y_.back() != 0.0;
  }
  exponent_y_ = -exponent_of(std::sqrt(squares / std::max(1, counted)));
  for (double& value : y_) value = std::ldexp(value, exponent_y_);
  const std::vector<std::int32_t> seeing = problem.a.seeing_rows();
  for (std::size_t m = 0; m < y_.size(); ++m) {
    const bool sees = std::binary_search(seeing.begin(), seeing.end(), static_cast<std::int32_t>(m));
    if (!sees) y_[m] = 0.0;
    dark_ += 0.5 * w_[m] * y_[m] * y_[m];
  }
}

std::vector<double> HardJudge::picture(const std::vector<float>& x) const {
  std::vector<double> scaled(x.begin(), x.end());
  for (double& value : scaled) value = std::ldexp(value, exponent_y_ - exponent_a_);
  return scaled;
}

recon::Objective HardJudge::objective(const recon::Objective& own) const {
  recon::Objective scaled = own;
  scaled.lambda = std::ldexp(own.lambda, exponent_a_ + exponent_y_);
  scaled.lo = std::ldexp(own.lo, exponent_y_ - exponent_a_);
  scaled.hi = std::ldexp(own.hi, exponent_y_ - exponent_a_);
  return scaled;
}

double HardJudge::value(const recon::Objective& own, recon::SolverKind solver, const std::vector<double>& x) {
  using Vector = Eigen::Map<const Eigen::VectorXd>;
  const Vector pixels(x.data(), a_.cols()), y(y_.data(), a_.rows()), w(w_.data(), a_.rows());
  const Eigen::VectorXd residual = a_ * pixels - y;
  const double fit = 0.5 * residual.dot(w.cwiseProduct(residual));
  if (solver == recon::solver_named("tikhonov")) {
    return fit + 0.5 * std::ldexp(own.lambda, 2 * exponent_a_) * pixels.squaredNorm();
  }
  if (!solver->minimises) return fit;
  Eigen::MatrixXd& psi = psi_[own.basis];
  if (psi.size() == 0) {
    psi = recon::reference::basis_matrix(own.basis, in_unit_.a.image_rows(), in_unit_.a.image_cols());
  }
  return fit + objective(own).lambda * (psi * pixels).cwiseAbs().sum();
}

std::optional<double> HardJudge::least(const recon::Objective& own) const {
  const auto best = recon::reference::solve_reference(in_unit_.a, objective(own), y_, w_);
  if (!best.converged) return std::nullopt;
  return std::min(best.objective, dark_);
}

double HardJudge::least_of_tikhonov(double lambda) const {
  const Eigen::Index m = a_.rows(), n = a_.cols();
  Eigen::MatrixXd stacked(m + n, n);
  Eigen::VectorXd samples = Eigen::VectorXd::Zero(m + n);
  for (Eigen::Index k = 0; k < m; ++k) {
    const double root = std::sqrt(w_[static_cast<std::size_t>(k)]);
    stacked.row(k) = root * a_.row(k);
    samples[k] = root * y_[static_cast<std::size_t>(k)];
  }
  stacked.bottomRows(n) = std::sqrt(std::ldexp(lambda, 2 * exponent_a_)) * Eigen::MatrixXd::Identity(n, n);
  return 0.5 * (stacked * recon::reference::least_squares(stacked, samples) - samples).squaredNorm();
}

}  // namespace compueye::tests
