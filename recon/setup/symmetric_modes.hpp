#pragma once

#include <Eigen/Core>

namespace compueye::recon {

/// Eigenvalues of a symmetric matrix, and their orthonormal eigenvectors, column by column in the same order.
struct SymmetricModes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

// Eigen's decompositions take the compiler seconds wherever they are called from: each has one object, for all of
// set-up.

/// All modes, smallest first; reads the lower triangle. Householder and QR.
[[nodiscard]] SymmetricModes symmetric_modes(const Eigen::MatrixXd& matrix);

/// The `count` < order - 1 largest modes, largest first, and the next eigenvalue behind theirs. Lanczos; false when it
/// did not settle.
[[nodiscard]] bool largest_modes(const Eigen::MatrixXd& matrix, Eigen::Index count, SymmetricModes& modes);

/// All singular values of a square matrix, largest first, and its right singular vectors, column by column.
void right_singular_pairs(const Eigen::MatrixXd& matrix, Eigen::VectorXd& values, Eigen::MatrixXd& vectors);

}  // namespace compueye::recon
