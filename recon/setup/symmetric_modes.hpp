#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace compueye::recon {

/// Eigenvalues of a symmetric matrix, and their orthonormal eigenvectors, column by column in the same order.
struct SymmetricModes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

// Eigen's decompositions take the compiler seconds wherever they are called from: each has one object, for all of
// set-up, which CMakeLists.txt keeps the sanitizers out of.

/// All modes, smallest first; reads the lower triangle. Householder and QR.
[[nodiscard]] SymmetricModes symmetric_modes(const Eigen::MatrixXd& matrix);

/// Their values alone.
[[nodiscard]] Eigen::VectorXd symmetric_values(const Eigen::MatrixXd& matrix);

/// The `count` < order - 1 largest modes, largest first, and the next eigenvalue behind theirs. Lanczos; false when it
/// did not settle.
[[nodiscard]] bool largest_modes(const Eigen::MatrixXd& matrix, Eigen::Index count, SymmetricModes& modes);

/// out = the symmetric matrix of some order times in.
using SymmetricProduct = std::function<void(const double* in, double* out)>;

/// How long Lanczos tries, and the relative error of an eigenvalue that it stops at.
struct LanczosEffort {
  int krylov = 40;
  int restarts = 10;
  double tolerance = 0.02;
};

/// The eigenvalue of largest magnitude; nothing when it did not settle. krylov <= order.
[[nodiscard]] std::optional<double> largest_magnitude(Eigen::Index order, const SymmetricProduct& product,
                                                      const LanczosEffort& effort);

/// All singular values, largest first; one-sided Jacobi, so that the small ones are as precise as the large.
[[nodiscard]] Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);

/// All singular values of a square matrix, largest first, and its right singular vectors, column by column.
void right_singular_pairs(const Eigen::MatrixXd& matrix, Eigen::VectorXd& values, Eigen::MatrixXd& vectors);

}  // namespace compueye::recon
