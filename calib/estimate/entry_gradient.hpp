#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/estimate/field_system.hpp"
#include "calib/estimate/row_parameters.hpp"

namespace compueye::calib {

/// A pixel's entry by each unknown of a solution: which of them count, and how much.
struct EntryGradient {
  std::vector<int> place;
  std::vector<double> value;

  void add(int at, double by) {
    if (at < 0 || by == 0.0) return;
    place.push_back(at);
    value.push_back(by);
  }
  /// The entry's variance.
  [[nodiscard]] double variance(const Eigen::MatrixXd& covariance) const;
};

/// Of pixel `support.pixels[j]`; the places are those of `solution`.
[[nodiscard]] EntryGradient gradient_of(const RowSupport& support, std::size_t j, const RowParameters& parameters,
                                        const FieldSystem::Solution& solution, int plane_cols);

}  // namespace compueye::calib
