#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "calib/estimate/cone_fit.hpp"
#include "calib/estimate/field_strengths.hpp"

namespace compueye::calib {

/// What the residual fields of one row are fitted by: everything linear about the fitted cone. Unknowns are the changes
/// of the cone's parameters, then each field's knots, all with a prior of mean nought.
class FieldSystem {
 public:
  /// `support` of `fit.cone`.
  FieldSystem(const ConeFit& fit, const RowSupport& support, const KnotGrid& grid, const ShownPatterns& patterns,
              const RowSamples& samples, const ConePrior& prior, int plane_cols);

  /// Of the patterns held out, by a fit to the others with fields of such strengths.
  struct Score {
    double log_likelihood = 0.0;
    double chi2 = 0.0;       ///< a point
    double inflation = 1.0;  ///< factor of the row's variance by which they scatter as stated, at least 1
  };
  [[nodiscard]] Score score(const FieldStrengths& strengths) const;

  /// The most probable unknowns given all patterns, and their covariance.
  struct Solution {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    Eigen::MatrixXd covariance_of_twice;              ///< had there been each pattern twice; empty: not asked for
    std::array<std::vector<int>, field_kinds> place;  ///< of each knot of the grid in the unknowns; -1: not among them
  };
  [[nodiscard]] Solution solve(const FieldStrengths& strengths, bool of_twice) const;

 private:
  struct Unknowns {
    std::vector<int> index;     // columns of slopes_
    Eigen::VectorXd precision;  // of each one's prior
  };
  struct Settled {
    Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> factor;
    Eigen::VectorXd mean;
  };
  [[nodiscard]] Settled settled(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right, const Unknowns& of) const;
  [[nodiscard]] Unknowns unknowns(const FieldStrengths& strengths) const;

  int fitted_;
  ConeVector cone_precision_, most_;                 // of the cone's moves: prior precision, and as far as they may go
  std::array<std::vector<int>, field_kinds> place_;  // of each knot in the columns of slopes_; -1: tells nothing
  std::array<int, field_kinds + 1> begin_{};         // columns of each field; the last is the end
  Eigen::MatrixXd slopes_;                           // patterns x unknowns, in standard deviations
  Eigen::VectorXd off_;                              // what the cone leaves of each pattern, likewise
  Eigen::VectorXd certainty_;
  Eigen::MatrixXd normal_fitted_, normal_all_;
  Eigen::VectorXd right_fitted_, right_all_;
};

}  // namespace compueye::calib
