#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/estimate/entry_gradient.hpp"
#include "calib/estimate/row_errors.hpp"

namespace compueye::calib {

/// Sums up the errors of a row over its entries.
class RowErrorSum {
 public:
  /// What an entry is, by how much it changes with each of the cone's parameters but the gain, and the variance that
  /// no covariance knows.
  struct Entry {
    double value = 0.0;
    std::array<double, ConeRow::changes> change{};
    double hidden_variance = 0.0;
  };
  void add(const Entry& entry, EntryGradient gradient);

  /// `covariance`: of the unknowns; `of_twice`: had there been each pattern twice.
  [[nodiscard]] RowErrors errors(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& of_twice) const;

 private:
  [[nodiscard]] Eigen::MatrixXd directions(Eigen::Index unknowns) const;
  [[nodiscard]] RowErrors::ByKind variances(const Eigen::MatrixXd& covariance) const;

  std::vector<Entry> entries_;
  std::vector<EntryGradient> gradients_;
};

}  // namespace compueye::calib
