#include <Spectra/SymEigsSolver.h>

#include "recon/setup/symmetric_modes.hpp"

namespace compueye::recon {
namespace {

/// A symmetric matrix as Spectra takes one.
class Operator {
 public:
  using Scalar = double;

  Operator(Eigen::Index order, const SymmetricProduct& product) : order_(order), product_(product) {}

  [[nodiscard]] Eigen::Index rows() const { return order_; }
  [[nodiscard]] Eigen::Index cols() const { return order_; }
  void perform_op(const double* in, double* out) const { product_(in, out); }

 private:
  Eigen::Index order_;
  const SymmetricProduct& product_;
};

}  // namespace

bool largest_modes(const Eigen::MatrixXd& matrix, Eigen::Index count, SymmetricModes& modes) {
  const SymmetricProduct product = [&](const double* in, double* out) {
    Eigen::Map<Eigen::VectorXd>(out, matrix.rows()).noalias() =
        matrix.selfadjointView<Eigen::Lower>() * Eigen::Map<const Eigen::VectorXd>(in, matrix.rows());
  };
  Operator whole(matrix.rows(), product);
  Spectra::SymEigsSolver<Operator> solver(whole, count + 1, 2 * count + 20);
  solver.init();
  constexpr int most_restarts = 300;
  constexpr double tolerance = 1e-9;
  if (solver.compute(Spectra::SortRule::LargestAlge, most_restarts, tolerance) < count + 1) return false;
  modes = {solver.eigenvalues(), solver.eigenvectors().leftCols(count)};
  return true;
}

std::optional<double> largest_magnitude(Eigen::Index order, const SymmetricProduct& product,
                                        const LanczosEffort& effort) {
  Operator whole(order, product);
  Spectra::SymEigsSolver<Operator> solver(whole, 1, effort.krylov);
  solver.init();
  if (solver.compute(Spectra::SortRule::LargestMagn, effort.restarts, effort.tolerance) < 1) return std::nullopt;
  return solver.eigenvalues()[0];
}

}  // namespace compueye::recon
