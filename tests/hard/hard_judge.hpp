#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "recon/reconstructor.hpp"
#include "studies/stability/hard_case.hpp"

namespace compueye::tests {

/// A case in units in which the rms of a column and of a sample is about 1, by powers of two, so that nothing rounds:
/// what a judge in double can work with whatever the case's own units are.
class HardJudge {
 public:
  explicit HardJudge(const firmware::HardProblem& problem);

  /// The picture of the case's own units in the judge's.
  [[nodiscard]] std::vector<double> picture(const std::vector<float>& x) const;

  /// The objective in the judge's units.
  [[nodiscard]] recon::Objective objective(const recon::Objective& own) const;

  /// What a picture is worth, in double; tikhonov: with its own penalty.
  [[nodiscard]] double value(const recon::Objective& objective, recon::SolverKind solver, const std::vector<double>& x);
  /// Of a dark picture.
  [[nodiscard]] double value_of_dark() const noexcept { return dark_; }

  /// The least value there is; nothing where the reference does not reach it.
  [[nodiscard]] std::optional<double> least(const recon::Objective& objective) const;
  [[nodiscard]] double least_of_tikhonov(double lambda) const;

 private:
  firmware::HardProblem in_unit_;
  Eigen::MatrixXd a_;
  std::vector<double> y_, w_;
  std::map<recon::BasisKind, Eigen::MatrixXd> psi_;  // those that were asked for
  int exponent_a_ = 0, exponent_y_ = 0;
  double dark_ = 0.0;
};

}  // namespace compueye::tests
