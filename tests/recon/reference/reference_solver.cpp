#include "tests/recon/reference/reference_solver.hpp"

#include <cmath>
#include <numbers>

#include "tests/recon/reference/dense_algebra.hpp"
#include "tests/recon/reference/interior_point.hpp"

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

Matrix fourier_matrix(int n) {
  Matrix f(n, n);
  for (int r = 0; r < n; ++r) {
    f(0, r) = std::sqrt(1.0 / n);
    for (int k = 1; 2 * k < n; ++k) {
      f(Eigen::Index{2} * k - 1, r) = std::sqrt(2.0 / n) * std::cos(2.0 * std::numbers::pi * k * r / n);
      f(Eigen::Index{2} * k, r) = std::sqrt(2.0 / n) * std::sin(2.0 * std::numbers::pi * k * r / n);
    }
    if (n % 2 == 0) f(n - 1, r) = (r % 2 == 0 ? 1.0 : -1.0) * std::sqrt(1.0 / n);
  }
  return f;
}

/// One level: row k the low-pass filter shifted by 2k, row n/2 + k the quadrature mirror filter, periodic.
Matrix wavelet_level(const std::vector<double>& low, int n) {
  const int taps = static_cast<int>(low.size());
  Matrix w = Matrix::Zero(n, n);
  for (int k = 0; k < n / 2; ++k) {
    for (int t = 0; t < taps; ++t) {
      w(k, (2 * k + t) % n) += low[static_cast<std::size_t>(t)];
      w(n / 2 + k, (2 * k + t) % n) += (t % 2 == 0 ? 1.0 : -1.0) * low[static_cast<std::size_t>(taps - 1 - t)];
    }
  }
  return w;
}

/// Daubechies' filter with four vanishing moments, from the roots of its polynomial as printed in "Ten Lectures on
/// Wavelets" (1992), table 6.1.
std::vector<double> low_pass(BasisKind basis) {
  if (basis == BasisKind::haar) return {std::sqrt(0.5), std::sqrt(0.5)};
  return {0.2303778133088964,  0.7148465705529154, 0.6308807679298587, -0.0279837694168599,
          -0.1870348117190931, 0.0308413818355607, 0.0328830116668852, -0.0105974017850690};
}

Matrix kronecker(const Matrix& a, const Matrix& b) {
  Matrix k(a.rows() * b.rows(), a.cols() * b.cols());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < a.cols(); ++j) k.block(i * b.rows(), j * b.cols(), b.rows(), b.cols()) = a(i, j) * b;
  }
  return k;
}

Matrix wavelet_matrix(BasisKind basis, int image_rows, int image_cols) {
  const std::vector<double> low = low_pass(basis);
  const int taps = static_cast<int>(low.size());
  const Eigen::Index pixels = Eigen::Index{image_rows} * image_cols;
  Matrix psi = Matrix::Identity(pixels, pixels);
  for (int rows = image_rows, cols = image_cols; rows % 2 == 0 && cols % 2 == 0 && rows >= taps && cols >= taps;
       rows /= 2, cols /= 2) {
    Matrix down = Matrix::Identity(image_rows, image_rows), across = Matrix::Identity(image_cols, image_cols);
    Matrix keep_down = Matrix::Zero(image_rows, image_rows), keep_across = Matrix::Zero(image_cols, image_cols);
    keep_down.topLeftCorner(rows, rows).setIdentity();
    keep_across.topLeftCorner(cols, cols).setIdentity();
    down.topLeftCorner(rows, rows) = wavelet_level(low, rows);
    across.topLeftCorner(cols, cols) = wavelet_level(low, cols);
    const Matrix inside = kronecker(keep_down, keep_across);
    const Matrix whole = Matrix::Identity(inside.rows(), inside.cols());
    psi = (kronecker(down, across) * inside + (whole - inside)) * psi;
  }
  return psi;
}

Matrix difference_matrix(int image_rows, int image_cols) {
  const Eigen::Index n = Eigen::Index{image_rows} * image_cols;
  Matrix d = Matrix::Zero(2 * n, n);
  for (int r = 0; r < image_rows; ++r) {
    for (int c = 0; c < image_cols; ++c) {
      const Eigen::Index p = Eigen::Index{r} * image_cols + c;
      if (c + 1 < image_cols) {
        d(p, p) = -1.0;
        d(p, p + 1) = 1.0;
      }
      if (r + 1 < image_rows) {
        d(n + p, p) = -1.0;
        d(n + p, p + image_cols) = 1.0;
      }
    }
  }
  return d;
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
  const Eigen::Index t = objective.lambda > 0.0 ? psi.rows() : 0;
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
    qp.g.block(0, 0, t, n) = psi;
    qp.g.block(t, 0, t, n) = -psi;
    qp.g.block(0, n, t, t) = -Matrix::Identity(t, t);
    qp.g.block(t, n, t, t) = -Matrix::Identity(t, t);
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
  switch (basis) {
    case BasisKind::identity:
      return Matrix::Identity(n, n);
    case BasisKind::dct:
      return kronecker(dct_matrix(image_rows), dct_matrix(image_cols));
    case BasisKind::dft:
      return kronecker(fourier_matrix(image_rows), fourier_matrix(image_cols));
    case BasisKind::haar:
    case BasisKind::db4:
      return wavelet_matrix(basis, image_rows, image_cols);
    case BasisKind::tv:
      return difference_matrix(image_rows, image_cols);
  }
  return {};
}

ReferenceResult solve_reference(const Response& response, const Objective& objective, std::span<const double> y,
                                std::span<const double> weights) {
  const Matrix a = dense(response);
  const Vector w = weights_or_ones(weights, response.rows());
  const Vector samples = usable_samples(y, w);
  ReferenceResult result;
  Vector x;
  if (objective.lambda == 0.0 && objective.constraint == ConstraintKind::none) {
    const Vector root = w.cwiseSqrt();
    x = least_squares(root.asDiagonal() * a, root.cwiseProduct(samples));
    result.converged = x.allFinite();
  } else {
    const Matrix psi = basis_matrix(objective.basis, response.image_rows(), response.image_cols());
    const QuadraticSolution solution = solve_interior_point(quadratic_program(a, samples, w, psi, objective));
    x = solution.z.head(a.cols());
    result.gap = solution.gap;
    result.converged = solution.converged;
  }
  result.x.assign(x.data(), x.data() + x.size());
  result.objective = objective_value(response, objective, y, weights, result.x);
  return result;
}

double objective_value(const Response& response, const Objective& objective, std::span<const double> y,
                       std::span<const double> weights, std::span<const double> x) {
  const Vector w = weights_or_ones(weights, response.rows());
  const Vector samples = usable_samples(y, w);
  const Eigen::Map<const Vector> pixels(x.data(), static_cast<Eigen::Index>(x.size()));
  const Vector residual = dense(response) * pixels - samples;
  const double fit = 0.5 * residual.dot(w.cwiseProduct(residual));
  if (objective.lambda == 0.0) return fit;
  const Vector coefficients = basis_matrix(objective.basis, response.image_rows(), response.image_cols()) * pixels;
  return fit + objective.lambda * coefficients.cwiseAbs().sum();
}

}  // namespace compueye::recon::reference
