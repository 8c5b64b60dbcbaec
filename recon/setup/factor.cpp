#include "recon/setup/factor.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <vector>

#include "hal/try.hpp"
#include "recon/core/parts/class_inverse.hpp"
#include "recon/problem/number_text.hpp"
#include "recon/setup/gram_matrix.hpp"
#include "recon/setup/on_all_cores.hpp"
#include "recon/setup/row_norms.hpp"
#include "recon/setup/set_up_time.hpp"
#include "recon/setup/step_sizes.hpp"
#include "recon/setup/tall_response.hpp"

namespace compueye::recon {
namespace {

using Matrix = Eigen::MatrixXd;

/// Largest eigenvalue of a positive definite matrix, from below and to a few per cent, which is all a limit needs.
double largest_eigenvalue(const Matrix& matrix) {
  // Neither constant nor alternating, so that it is orthogonal to no smooth eigenvector.
  Eigen::VectorXd v(matrix.rows());
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = 1.0 + static_cast<double>(i * 7 % 13) / 13.0;
  double norm = 0.0;
  for (int k = 0; k < 20; ++k) {
    v.normalize();
    v = (matrix.selfadjointView<Eigen::Lower>() * v).eval();
    norm = v.norm();
  }
  return norm;
}

/// Norms of A A' + rho I and of its inverse in one parity class.
struct ClassNorms {
  double matrix = 0.0;
  double inverse = 0.0;
};

/// matrix becomes (S (matrix + rho I) S)^-1, S the diagonal `scale`, empty: I; false when it is not positive definite.
bool invert(Matrix& matrix, double rho, const Eigen::VectorXd& scale, ClassNorms& norms) {
  if (matrix.size() == 0) return true;
  matrix.diagonal().array() += rho;
  if (scale.size() > 0) matrix = (scale.asDiagonal() * matrix * scale.asDiagonal()).eval();
  norms.matrix = largest_eigenvalue(matrix);
  Eigen::LLT<Eigen::Ref<Matrix>> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  Matrix inverse = Matrix::Identity(matrix.rows(), matrix.cols());
  factor.solveInPlace(inverse);
  matrix = 0.5 * (inverse + inverse.transpose());
  norms.inverse = largest_eigenvalue(matrix);
  return matrix.allFinite();
}

/// Rounding the inverse moves its eigenvalues by `rounding` of the largest: beyond the smallest, it is noise.
hal::Result<void> check_condition(const std::vector<ClassNorms>& classes, bool definite, double rho, double rounding) {
  double norm = 0.0, inverse_norm = 0.0;
  for (const ClassNorms& norms : classes) {
    norm = std::max(norm, norms.matrix);
    inverse_norm = std::max(inverse_norm, norms.inverse);
  }
  if (definite && norm * inverse_norm * rounding < 0.5) return {};
  return hal::fail(hal::ErrorCode::out_of_range, "rho",
                   "is " + number_text(rho) + ", too small for this response (||A||^2 is " + number_text(norm) +
                       ") at this precision; expected " + number_text(4.0 * rounding * norm) +
                       " or more (for tikhonov, rho is lambda), or double precision");
}

/// Those of block c's orbits, whose rows all have the scale of the first.
Eigen::VectorXd scale_of_class(const ParityClasses& classes, std::size_t c, const std::vector<double>& scale) {
  if (scale.empty()) return {};
  Eigen::VectorXd of_class(classes.order(c));
  const auto& orbits = classes.orbits();
  for (std::size_t orbit = 0; orbit < orbits.size(); ++orbit) {
    const int at = classes.position(c, static_cast<int>(orbit));
    if (at >= 0) of_class[at] = scale[static_cast<std::size_t>(orbits[orbit].first)];
  }
  return of_class;
}

/// Of the inverse of one class.
double seconds_to_invert(Eigen::Index order) {
  return seconds_of(order, 3.0, [](Eigen::Index small) {
    Matrix matrix = matrix_to_try(small);
    ClassNorms norms;
    static_cast<void>(invert(matrix, 1.0, {}, norms));
  });
}

hal::Result<void> invert_blocks(ParityGram& gram, double rho, const std::vector<double>& scale, double rounding,
                                double expected_s, const Progress& progress) {
  std::vector<ClassNorms> norms(gram.classes().count());
  std::atomic<bool> definite{true};
  const bool inverted = on_all_cores(
      static_cast<int>(gram.classes().count()), "inverse", progress,
      [&] {
        return [&](int c) {
          const auto at = static_cast<std::size_t>(c);
          if (!invert(gram.block(at), rho, scale_of_class(gram.classes(), at, scale), norms[at])) definite = false;
        };
      },
      expected_s);
  if (inverted) return check_condition(norms, definite, rho, rounding);
  return hal::fail(hal::ErrorCode::interrupted, "set-up", "stopped before the factor was finished");
}

std::vector<double> packed(const Matrix& matrix) {
  std::vector<double> values;
  values.reserve(core::PackedSymmetric<double>::size(static_cast<std::size_t>(matrix.rows())));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = i; j < matrix.cols(); ++j) values.push_back(matrix(i, j));
  }
  return values;
}

/// matrix += rho (I + D'D), D the differences of neighbouring pixels.
void add_smoothing(double rho, Eigen::Index image_rows, Eigen::Index image_cols, Matrix& matrix) {
  const auto add_difference = [&](Eigen::Index one, Eigen::Index other) {
    matrix(one, one) += rho;
    matrix(other, other) += rho;
    matrix(one, other) -= rho;
    matrix(other, one) -= rho;
  };
  matrix.diagonal().array() += rho;
  for (Eigen::Index r = 0; r < image_rows; ++r) {
    for (Eigen::Index c = 0; c < image_cols; ++c) {
      const Eigen::Index at = r * image_cols + c;
      if (c + 1 < image_cols) add_difference(at, at + 1);
      if (r + 1 < image_rows) add_difference(at, at + image_cols);
    }
  }
}

/// ||A||^2 with loud rows turned down: their own rounding stays in their own direction.
double bulk_norm(const Response& seeing, double rho) {
  const std::vector<double> scale = loud_row_scale(seeing, rho);
  if (scale.empty()) return squared_norm_bound(seeing);
  std::vector<std::int32_t> rows(scale.size());
  std::iota(rows.begin(), rows.end(), 0);
  return squared_norm_bound(seeing.select_rows(rows, scale));
}

}  // namespace

std::size_t factor_size(const ParityClasses& classes) noexcept {
  std::size_t total = 0;
  for (std::size_t c = 0; c < classes.count(); ++c) {
    total += core::PackedSymmetric<float>::size(static_cast<std::size_t>(classes.order(c)));
  }
  return total;
}

template <class T>
hal::Result<std::vector<T>> packed_inverse(const Response& seeing, MetricKind metric, double rho,
                                           const Progress& progress) {
  ParityGram gram(seeing, metric);
  constexpr double rounding = 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon());
  const double inverse_s =
      seconds_of_classes(gram.classes(), [&](std::size_t c) { return seconds_to_invert(gram.classes().order(c)); });
  expect_set_up(progress, seconds_to_fill(gram) + inverse_s);
  if (auto made = gram.fill(progress); !made) return tl::unexpected(made.error());
  if (auto done = invert_blocks(gram, rho, loud_row_scale(seeing, rho), rounding, inverse_s, progress); !done)
    return tl::unexpected(done.error());
  std::vector<T> packed;
  packed.reserve(factor_size(gram.classes()));
  for (std::size_t c = 0; c < gram.classes().count(); ++c) {
    const Matrix& block = gram.block(c);
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      for (Eigen::Index j = i; j < block.cols(); ++j) packed.push_back(static_cast<T>(block(i, j)));
    }
  }
  return packed;
}

hal::Result<PixelFactor> pixel_factor(const Response& seeing, MetricKind metric, double rho, double rounding,
                                      const Progress& progress) {
  expect_set_up(progress, seconds_of_triangle(seeing) + seconds_to_invert(seeing.cols()));
  const Matrix r = TRY(triangle(seeing, progress));
  Matrix matrix = r.transpose() * r;
  if (metric == MetricKind::identity) {
    matrix.diagonal().array() += rho;
  } else {
    add_smoothing(rho, seeing.image_rows(), seeing.image_cols(), matrix);
  }
  PixelFactor factor{packed(matrix), {}};
  ClassNorms norms;
  const bool definite = invert(matrix, 0.0, {}, norms);
  TRY(check_condition({norms}, definite, rho, 0.5 * std::numeric_limits<double>::epsilon()));
  norms.matrix = bulk_norm(seeing, rho) + rho;
  TRY(check_condition({norms}, definite, rho, rounding));
  factor.inverse = packed(matrix);
  return factor;
}

template hal::Result<std::vector<float>> packed_inverse(const Response&, MetricKind, double, const Progress&);
template hal::Result<std::vector<double>> packed_inverse(const Response&, MetricKind, double, const Progress&);

}  // namespace compueye::recon
