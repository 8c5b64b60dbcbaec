#include "calib/estimate/shared_fit.hpp"
#include "calib/median.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace compueye::calib {
namespace {

/// Distance, lean, tilt, ln gamma, black level.
constexpr int shared_count = 5;
using SharedVector = Eigen::Matrix<double, shared_count, 1>;
using SharedMatrix = Eigen::Matrix<double, shared_count, shared_count>;
using ConeMatrix = Eigen::Matrix<double, cone_parameters, cone_parameters>;

constexpr int most_rounds = 8;
/// A pass that moves everything by less than so much of its own sigma is the last.
constexpr double small_move = 0.02;
constexpr double distance_share = 0.02, turn_rad = 0.05, log_gamma = 0.5, black_level = 0.1;  // prior
constexpr double least_pose_rad = 1e-4;
constexpr double step_rad = 1e-5, step_log_gamma = 1e-3, step_share = 1e-5;
constexpr double to_deviation = 1.4826;  // of a normal distribution, from its median absolute deviation

bool has_greys(const Captures& captures) {
  return std::any_of(captures.patterns.begin(), captures.patterns.end(), [](float v) { return v > 0.0F && v < 1.0F; });
}

SharedVector vector_of(const SharedParameters& p) {
  SharedVector v;
  v << p.plane.distance_mm, p.plane.lean_rad, p.plane.tilt_rad, std::log(p.display.gamma), p.display.black_level;
  return v;
}

SharedParameters parameters_of(const SharedVector& v) {
  return {{v[0], v[1], v[2]}, {std::exp(v[3]), std::clamp(v[4], 0.0, 0.5)}};
}

struct Normal {
  SharedMatrix matrix = SharedMatrix::Zero();
  SharedVector right = SharedVector::Zero();
};

class SharedFitter {
 public:
  SharedFitter(SoftCone& model, std::span<const int> channels, const Captures& captures, const LightSamples& samples,
               const ConePrior& prior, const SharedFitSettings& settings)
      : model_(model), channels_(channels), captures_(captures), samples_(samples), prior_(prior) {
    const bool gamma = settings.display && has_greys(captures);
    fitted_ = {settings.plane, settings.plane, settings.plane, gamma, settings.display};
    deviation_ << distance_share * model.plane().distance_mm, turn_rad, turn_rad, log_gamma, black_level;
  }

  SharedFit fit() && {
    SharedFit found;
    SharedVector at = SharedVector::Zero(), sigma = SharedVector::Zero();
    const bool any = std::any_of(fitted_.begin(), fitted_.end(), [](bool each) { return each; });
    while (any && found.passes < most_rounds) {
      const Normal normal = look(at);
      const SharedMatrix covariance = normal.matrix.inverse();
      const SharedVector move = covariance * normal.right;
      sigma = covariance.diagonal().cwiseSqrt();
      at = vector_of(parameters_of(at + move));
      ++found.passes;
      if ((move.array().abs() < small_move * sigma.array()).all()) break;
    }
    for (int s = 0; s < shared_count; ++s) {
      if (!fitted_[static_cast<std::size_t>(s)]) sigma[s] = 0.0;
    }
    found.value = parameters_of(at);
    found.sigma = {{sigma[0], sigma[1], sigma[2]}, {found.value.display.gamma * sigma[3], sigma[4]}};
    return found;
  }

 private:
  Normal look(const SharedVector& at) {
    const SharedParameters here = parameters_of(at);
    const int pixels = model_.plane().pixels(), columns = model_.eye().columns;
    const ShownPatterns shown(captures_, pixels, here.display);
    const DisplayResponse brighter{here.display.gamma * std::exp(step_log_gamma), here.display.black_level};
    const ShownPatterns otherwise(captures_, fitted_[3] ? pixels : 0, brighter);
    std::vector<ConeFit> fits;
    for (const int m : channels_) {
      fits.push_back(
          fit_cone(model_, m / columns, m % columns, here.plane, shown, row_samples(samples_, shown, m), prior_));
    }
    const ConeVector precision = cone_precision(fits);
    Normal normal;
    for (std::size_t r = 0; r < fits.size(); ++r) {
      add_row(channels_[r], here, shown, otherwise, fits[r], precision, normal);
    }
    normal.matrix.diagonal() += deviation_.cwiseAbs2().cwiseInverse();
    normal.right -= at.cwiseQuotient(deviation_.cwiseAbs2());
    for (int s = 0; s < shared_count; ++s) {
      if (fitted_[static_cast<std::size_t>(s)]) continue;
      normal.matrix.row(s).setZero();
      normal.matrix.col(s).setZero();
      normal.matrix(s, s) = 1.0;
      normal.right[s] = 0.0;
    }
    return normal;
  }

  [[nodiscard]] ConeVector cone_precision(const std::vector<ConeFit>& fits) const {
    std::vector<double> tilts;
    for (const ConeFit& fit : fits) {
      tilts.push_back(std::abs(fit.cone.tilt_one_rad));
      tilts.push_back(std::abs(fit.cone.tilt_other_rad));
    }
    ConePrior built = prior_;
    built.pose_rad = std::clamp(to_deviation * median(std::move(tilts)), least_pose_rad, prior_.pose_rad);
    return deviations(built).cwiseAbs2().cwiseInverse();
  }

  void add_row(int m, const SharedParameters& here, const ShownPatterns& shown, const ShownPatterns& otherwise,
               const ConeFit& fit, const ConeVector& precision, Normal& normal) {
    if (fit.row.size() == 0) return;
    const auto fitted = shown.fitted();
    // A cone that fits badly (dust) says accordingly little.
    const double weight = 1.0 / std::sqrt(std::max(fit.held_out_chi2, 1.0));
    const Eigen::VectorXd certainty = weight * fit.certainty.head(fitted);
    const Eigen::MatrixXd own = certainty.asDiagonal() * cone_slopes(shown, fit.row, fit.cone.gain).topRows(fitted);
    const Eigen::MatrixXd common =
        certainty.asDiagonal() * common_slopes(m, here, shown, otherwise, fit).topRows(fitted);
    const RowSamples samples = row_samples(samples_, shown, m);
    const Eigen::VectorXd off = certainty.cwiseProduct((samples.light - fit.predicted).head(fitted));
    ConeMatrix own_normal = own.transpose() * own;
    own_normal.diagonal() += precision;
    const ConeVector own_right = own.transpose() * off - precision.cwiseProduct(departure(fit.cone, model_.drawn()));
    const Eigen::Matrix<double, cone_parameters, shared_count> crossed = own.transpose() * common;
    const auto factor = own_normal.ldlt();
    normal.matrix += common.transpose() * common - crossed.transpose() * factor.solve(crossed);
    normal.right += common.transpose() * off - crossed.transpose() * factor.solve(own_right);
  }

  [[nodiscard]] Eigen::MatrixXd common_slopes(int m, const SharedParameters& here, const ShownPatterns& shown,
                                              const ShownPatterns& otherwise, const ConeFit& fit) {
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(shown.count(), shared_count);
    const std::array<double, 3> steps{step_share * model_.plane().distance_mm, step_rad, step_rad};
    for (int s = 0; s < 3 && fitted_[0]; ++s) {
      SharedVector moved = vector_of(here);
      moved[s] += steps[static_cast<std::size_t>(s)];
      ConeRow row;
      model_.expose(m / model_.eye().columns, m % model_.eye().columns, fit.cone, parameters_of(moved).plane, row);
      Eigen::VectorXd predicted = Eigen::VectorXd::Zero(shown.count());
      shown.add(row.pixels, row.covered, predicted);
      slopes.col(s) = (fit.cone.gain * predicted - fit.predicted) / steps[static_cast<std::size_t>(s)];
    }
    if (fitted_[3]) {
      Eigen::VectorXd predicted = Eigen::VectorXd::Zero(shown.count());
      otherwise.add(fit.row.pixels, fit.row.covered, predicted);
      slopes.col(3) = (fit.cone.gain * predicted - fit.predicted) / step_log_gamma;
    }
    if (fitted_[4]) {
      double white = 0.0;
      for (const double covered : fit.row.covered) white += fit.cone.gain * covered;
      slopes.col(4) = (white - fit.predicted.array()).matrix() / (1.0 - here.display.black_level);
    }
    return slopes;
  }

  SoftCone& model_;
  std::span<const int> channels_;
  const Captures& captures_;
  const LightSamples& samples_;
  const ConePrior& prior_;
  std::array<bool, shared_count> fitted_{};
  SharedVector deviation_;
};

}  // namespace

SharedFit fit_shared(SoftCone& model, std::span<const int> channels, const Captures& captures,
                     const LightSamples& samples, const ConePrior& prior, const SharedFitSettings& settings) {
  return SharedFitter(model, channels, captures, samples, prior, settings).fit();
}

}  // namespace compueye::calib
