#include "calib/estimate/cone_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace compueye::calib {
namespace {

constexpr int most_steps = 40;
constexpr double least_damping = 1e-9, first_damping = 1e-3, most_damping = 1e9;
/// Of chi^2 a point: a step that gains less is the last one.
constexpr double least_gain = 1e-4;

/// The samples' and the prior's residuals at one set of parameters, in standard deviations.
struct Look {
  ConeVector at = ConeVector::Zero();
  ConeRow row;
  Eigen::VectorXd predicted;
  double cost = std::numeric_limits<double>::infinity();
};

class Fitter {
 public:
  Fitter(SoftCone& model, int i, int k, const PlaneError& plane, const ShownPatterns& patterns,
         const RowSamples& samples, const ConePrior& prior)
      : model_(model),
        i_(i),
        k_(k),
        plane_(plane),
        patterns_(patterns),
        samples_(samples),
        prior_(deviations(prior)),
        drawn_(model.drawn()) {}

  ConeFit fit() && {
    Look here = look(begin());
    int steps = 0;
    // Certainties follow from the light, which the first fit tells better than any noisy sample.
    for (const bool last : {false, true}) {
      certainty_ = samples_.certainty(here.predicted);
      here.cost = cost(here);
      steps += descend(here);
      if (samples_.light_variance.isZero() || last) break;
    }
    ConeFit found;
    found.cone = departed(drawn_, here.at);
    found.certainty = samples_.certainty(here.predicted);
    const auto judging = patterns_.count() - patterns_.fitted();
    const Eigen::ArrayXd off = (samples_.light - here.predicted).cwiseProduct(found.certainty).tail(judging).array();
    const auto points = static_cast<double>((found.certainty.tail(judging).array() > 0.0).count());
    found.held_out_chi2 = off.square().sum() / std::max(points, 1.0);
    found.row = std::move(here.row);
    found.predicted = std::move(here.predicted);
    found.steps = steps;
    return found;
  }

 private:
  [[nodiscard]] Look look(const ConeVector& at) {
    Look seen;
    seen.at = at;
    const ConeParameters cone = departed(drawn_, at);
    model_.expose(i_, k_, cone, plane_, seen.row);
    seen.predicted = Eigen::VectorXd::Zero(patterns_.count());
    patterns_.add(seen.row.pixels, seen.row.covered, seen.predicted);
    seen.predicted *= cone.gain;
    if (certainty_.size() > 0) seen.cost = cost(seen);
    return seen;
  }

  [[nodiscard]] double cost(const Look& seen) const {
    const auto fitted = patterns_.fitted();
    return (samples_.light - seen.predicted).head(fitted).cwiseProduct(certainty_.head(fitted)).squaredNorm() +
           seen.at.cwiseQuotient(prior_).squaredNorm();
  }

  /// The drawn cone with the gain that fits it best.
  [[nodiscard]] ConeVector begin() {
    const Look drawn = look(ConeVector::Zero());
    const auto fitted = patterns_.fitted();
    double product = 0.0, square = 0.0;
    for (Eigen::Index p = 0; p < fitted; ++p) {
      if (std::isinf(samples_.fixed_variance[p])) continue;
      product += samples_.light[p] * drawn.predicted[p];
      square += drawn.predicted[p] * drawn.predicted[p];
    }
    ConeVector at = ConeVector::Zero();
    if (square > 0.0) at[4] = std::log(std::clamp(product / square, 1e-3, 1e3));
    return at;
  }

  /// Number of steps tried.
  int descend(Look& here) {
    double damping = first_damping;
    const auto fitted = patterns_.fitted();
    int steps = 0;
    while (steps < most_steps && damping < most_damping && here.row.size() > 0) {
      const double gain = departed(drawn_, here.at).gain;
      const Eigen::MatrixXd slopes =
          certainty_.head(fitted).asDiagonal() * cone_slopes(patterns_, here.row, gain).topRows(fitted);
      const Eigen::VectorXd off = (samples_.light - here.predicted).head(fitted).cwiseProduct(certainty_.head(fitted));
      Eigen::Matrix<double, cone_parameters, cone_parameters> normal = slopes.transpose() * slopes;
      normal.diagonal() += prior_.cwiseAbs2().cwiseInverse();
      const ConeVector downhill = slopes.transpose() * off - here.at.cwiseQuotient(prior_.cwiseAbs2());
      double gained = -1.0;
      while (gained < 0.0 && steps < most_steps && damping < most_damping) {
        auto damped = normal;
        damped.diagonal() *= 1.0 + damping;
        Look next = look(here.at + damped.ldlt().solve(downhill));
        gained = here.cost - next.cost;
        if (!(gained >= 0.0)) gained = -1.0;
        damping = gained < 0.0 ? damping * 10.0 : std::max(damping * 0.1, least_damping);
        if (gained >= 0.0) here = std::move(next);
        ++steps;
      }
      if (gained < least_gain * here.cost / std::max(fitted, 1)) break;
    }
    return steps;
  }

  SoftCone& model_;
  int i_, k_;
  const PlaneError& plane_;
  const ShownPatterns& patterns_;
  const RowSamples& samples_;
  ConeVector prior_;
  ConeParameters drawn_;
  Eigen::VectorXd certainty_;
};

}  // namespace

Eigen::VectorXd RowSamples::certainty(const Eigen::VectorXd& light_expected) const {
  return (fixed_variance + light_variance.cwiseProduct(light_expected.cwiseMax(0.0))).cwiseSqrt().cwiseInverse();
}

RowSamples row_samples(const LightSamples& samples, const ShownPatterns& patterns, int channel) {
  RowSamples row;
  const auto count = patterns.count();
  row.light = row.fixed_variance = row.light_variance = Eigen::VectorXd::Zero(count);
  for (int k = 0; k < count; ++k) {
    const std::size_t p = patterns.capture(k);
    const double light = samples.at(p, static_cast<std::size_t>(channel));
    row.light[k] = std::isnan(light) ? 0.0 : light;
    row.fixed_variance[k] = std::isnan(light) ? std::numeric_limits<double>::infinity() : samples.fixed_variance[p];
    row.light_variance[k] = samples.light_variance[p];
  }
  return row;
}

ConeVector departure(const ConeParameters& cone, const ConeParameters& drawn) {
  ConeVector at;
  at << cone.tilt_one_rad, cone.tilt_other_rad, std::log(cone.half_angle_rad / drawn.half_angle_rad),
      std::log(cone.order / drawn.order), std::log(cone.gain / drawn.gain);
  return at;
}

ConeParameters departed(const ConeParameters& drawn, const ConeVector& departure) {
  ConeParameters cone = drawn;
  cone.tilt_one_rad = departure[0];
  cone.tilt_other_rad = departure[1];
  cone.half_angle_rad *= std::exp(departure[2]);
  cone.order *= std::exp(departure[3]);
  cone.gain *= std::exp(departure[4]);
  return cone;
}

ConeVector deviations(const ConePrior& prior) {
  ConeVector each;
  each << prior.pose_rad, prior.pose_rad, prior.half_angle, prior.order, prior.gain;
  return each;
}

ConeFit fit_cone(SoftCone& model, int i, int k, const PlaneError& plane, const ShownPatterns& patterns,
                 const RowSamples& samples, const ConePrior& prior) {
  return Fitter(model, i, k, plane, patterns, samples, prior).fit();
}

Eigen::MatrixXd cone_slopes(const ShownPatterns& patterns, const ConeRow& row, double gain) {
  Eigen::MatrixXd slopes(patterns.count(), cone_parameters);
  for (int d = 0; d < cone_parameters; ++d) {
    const auto& entries = d < 4 ? row.change[static_cast<std::size_t>(d)] : row.covered;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(patterns.count());
    patterns.add(row.pixels, entries, sum);
    slopes.col(d) = gain * sum;
  }
  return slopes;
}

}  // namespace compueye::calib
