#include "recon/reference/reference_solver.hpp"

#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "recon/reference/interior_point.hpp"

namespace compueye::recon::reference {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

Matrix dct_matrix(int n) {
  Matrix c(n, n);
  for (int k = 0; k < n; ++k) {
    for (int r = 0; r < n; ++r) {
      c(k, r) = std::sqrt((k == 0 ? 1.0 : 2.0) / n) * std::cos(std::numbers::pi * (r + 0.5) * k / n);
    }
  }
  return c;
}

Matrix dense(const Response& response) {
  Matrix a = Matrix::Zero(response.rows(), response.cols());
  for (int m = 0; m < response.rows(); ++m) {
    response.for_each_in_row(m, [&](std::int32_t n, double v) { a(m, n) = v; });
  }
  return a;
}

Vector weights_or_ones(std::span<const double> weights, int rows) {
  if (weights.empty()) return Vector::Ones(rows);
  return Eigen::Map<const Vector>(weights.data(), rows);
}

/// Masked samples may be NaN; they carry no weight.
Vector usable_samples(std::span<const double> y, const Vector& w) {
  Vector samples = Eigen::Map<const Vector>(y.data(), static_cast<Eigen::Index>(y.size()));
  for (Eigen::Index m = 0; m < samples.size(); ++m) {
    if (w[m] == 0.0) samples[m] = 0.0;
  }
  return samples;
}

/// Variables (x, t); rows: Psi x - t <= 0, -Psi x - t <= 0, x <= hi, -x <= -lo.
QuadraticProgram quadratic_program(const Matrix& a, const Vector& y, const Vector& w, const Matrix& psi,
                                   const Objective& objective) {
  const Eigen::Index n = a.cols();
  const Eigen::Index t = objective.lambda > 0.0 ? n : 0;
  const bool upper = objective.constraint == ConstraintKind::box;
  const bool lower = objective.constraint != ConstraintKind::none;
  QuadraticProgram qp;
  qp.p = Matrix::Zero(n + t, n + t);
  qp.p.topLeftCorner(n, n) = a.transpose() * w.asDiagonal() * a;
  qp.q = Vector::Constant(n + t, objective.lambda);
  qp.q.head(n) = -(a.transpose() * w.cwiseProduct(y));
  qp.g = Matrix::Zero(2 * t + (upper ? n : 0) + (lower ? n : 0), n + t);
  qp.h = Vector::Zero(qp.g.rows());
  if (t > 0) {
    qp.g.block(0, 0, n, n) = psi;
    qp.g.block(n, 0, n, n) = -psi;
    qp.g.block(0, n, n, n) = -Matrix::Identity(n, n);
    qp.g.block(n, n, n, n) = -Matrix::Identity(n, n);
  }
  if (upper) {
    qp.g.block(2 * t, 0, n, n) = Matrix::Identity(n, n);
    qp.h.segment(2 * t, n).setConstant(objective.hi);
  }
  if (lower) {
    qp.g.bottomLeftCorner(n, n) = -Matrix::Identity(n, n);
    qp.h.tail(n).setConstant(objective.constraint == ConstraintKind::box ? -objective.lo : 0.0);
  }
  return qp;
}

}  // namespace

Matrix basis_matrix(BasisKind basis, int image_rows, int image_cols) {
  const int n = image_rows * image_cols;
  if (basis == BasisKind::identity) return Matrix::Identity(n, n);
  const Matrix down = dct_matrix(image_rows), across = dct_matrix(image_cols);
  Matrix psi(n, n);
  for (int k = 0; k < n; ++k) {
    for (int p = 0; p < n; ++p) {
      psi(k, p) = down(k / image_cols, p / image_cols) * across(k % image_cols, p % image_cols);
    }
  }
  return psi;
}

ReferenceResult solve_reference(const Response& response, int image_rows, int image_cols, const Objective& objective,
                                std::span<const double> y, std::span<const double> weights) {
  const Matrix a = dense(response);
  const Vector w = weights_or_ones(weights, response.rows());
  const Vector samples = usable_samples(y, w);
  ReferenceResult result;
  Vector x;
  if (objective.lambda == 0.0 && objective.constraint == ConstraintKind::none) {
    const Vector root = w.cwiseSqrt();
    x = (root.asDiagonal() * a).eval().completeOrthogonalDecomposition().solve(root.cwiseProduct(samples));
    result.converged = x.allFinite();
  } else {
    const Matrix psi = basis_matrix(objective.basis, image_rows, image_cols);
    const QuadraticSolution solution = solve_interior_point(quadratic_program(a, samples, w, psi, objective));
    x = solution.z.head(a.cols());
    result.gap = solution.gap;
    result.converged = solution.converged;
  }
  result.x.assign(x.data(), x.data() + x.size());
  result.objective = objective_value(response, image_rows, image_cols, objective, y, weights, result.x);
  return result;
}

double objective_value(const Response& response, int image_rows, int image_cols, const Objective& objective,
                       std::span<const double> y, std::span<const double> weights, std::span<const double> x) {
  const Vector w = weights_or_ones(weights, response.rows());
  const Vector samples = usable_samples(y, w);
  const Eigen::Map<const Vector> pixels(x.data(), static_cast<Eigen::Index>(x.size()));
  const Vector residual = dense(response) * pixels - samples;
  const double fit = 0.5 * residual.dot(w.cwiseProduct(residual));
  if (objective.lambda == 0.0) return fit;
  const Vector coefficients = basis_matrix(objective.basis, image_rows, image_cols) * pixels;
  return fit + objective.lambda * coefficients.cwiseAbs().sum();
}

}  // namespace compueye::recon::reference
