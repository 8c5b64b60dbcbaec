#pragma once

#include <Eigen/Core>

#include "calib/estimate/light_samples.hpp"
#include "calib/estimate/shown_patterns.hpp"
#include "calib/estimate/soft_cone.hpp"

namespace compueye::calib {

/// What one channel read of the shown patterns, in their order.
struct RowSamples {
  Eigen::VectorXd light;           ///< 0 where there is none
  Eigen::VectorXd fixed_variance;  ///< infinite where there is none
  Eigen::VectorXd light_variance;

  /// 1 / standard deviation of each sample, if it is of so much light.
  [[nodiscard]] Eigen::VectorXd certainty(const Eigen::VectorXd& light_expected) const;
};

[[nodiscard]] RowSamples row_samples(const LightSamples& samples, const ShownPatterns& patterns, int channel);

/// How far a built ommatidium is expected to be from its drawing; standard deviations. They decide only where the
/// samples do not.
struct ConePrior {
  double pose_rad = 0.03;
  double half_angle = 0.2;  ///< of the logarithm
  double order = 1.0;       ///< of the logarithm, about that of SoftCone::drawn()
  double gain = 3.0;        ///< of the logarithm
};

/// Order of everything that counts a cone's parameters: the changes of ConeRow, then ln gain.
inline constexpr int cone_parameters = 5;
using ConeVector = Eigen::Matrix<double, cone_parameters, 1>;

[[nodiscard]] ConeVector departure(const ConeParameters& cone, const ConeParameters& drawn);
[[nodiscard]] ConeParameters departed(const ConeParameters& drawn, const ConeVector& departure);
[[nodiscard]] ConeVector deviations(const ConePrior& prior);

/// A cone fitted to a channel's samples, without those of the patterns held out.
struct ConeFit {
  ConeParameters cone;
  ConeRow row;                ///< of that cone
  Eigen::VectorXd predicted;  ///< of every pattern, held out or not
  Eigen::VectorXd certainty;  ///< by the light predicted
  double held_out_chi2 = 0.0;
  int steps = 0;
};

/// Levenberg-Marquardt from the drawn cone (Marquardt 1963, "An algorithm for least-squares estimation of nonlinear
/// parameters"), with the prior as five more residuals.
[[nodiscard]] ConeFit fit_cone(SoftCone& model, int i, int k, const PlaneError& plane, const ShownPatterns& patterns,
                               const RowSamples& samples, const ConePrior& prior);

/// d predicted / d parameter, patterns x cone_parameters, at `cone` whose row is `row`.
[[nodiscard]] Eigen::MatrixXd cone_slopes(const ShownPatterns& patterns, const ConeRow& row, double gain);

}  // namespace compueye::calib
