#include <Spectra/MatOp/DenseSymMatProd.h>
#include <Spectra/SymEigsSolver.h>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {

bool largest_modes(const Eigen::MatrixXd& matrix, Eigen::Index count, SymmetricModes& modes) {
  Spectra::DenseSymMatProd<double> product(matrix);
  Spectra::SymEigsSolver<Spectra::DenseSymMatProd<double>> solver(product, count + 1, 2 * count + 20);
  solver.init();
  constexpr int most_restarts = 300;
  constexpr double tolerance = 1e-9;
  if (solver.compute(Spectra::SortRule::LargestAlge, most_restarts, tolerance) < count + 1) return false;
  modes = {solver.eigenvalues(), solver.eigenvectors().leftCols(count)};
  return true;
}

}  // namespace compueye::recon
