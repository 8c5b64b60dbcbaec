#include "calib/estimate/field_system.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace compueye::calib {
namespace {

/// Knots whose signal is less than so much of the strongest one's are left out: nothing could be told of them.
constexpr double least_signal = 1e-3;
using ConeMatrix = Eigen::Matrix<double, cone_parameters, cone_parameters>;

/// A cone may move with the fields by so many of its standard deviations as fitted alone. Without that bound cone and
/// fields would trade the same light, farther than a straight line holds; without any such move its uncertainty would
/// be left out of the entries'.
constexpr double most_deviations = 3.0;
/// And by no more than this: tilts in half angles, then the logarithms.
constexpr double most_tilt = 0.03, most_half = 0.03, most_order = 0.3, most_gain = 0.1;
constexpr double by_chance = 1.3;       // standard errors
constexpr double standing_still = 1e6;  // times the precision

/// Signals of a field's knots (patterns x knots): what each pattern reads through envelope x splines. Splines across
/// are summed along each row of pixels first, which saves three quarters of the work.
Eigen::MatrixXf knot_signals(const RowSupport& support, const std::vector<double>& envelope, const KnotGrid& grid,
                             const ShownPatterns& patterns, int plane_cols) {
  Eigen::MatrixXf signals = Eigen::MatrixXf::Zero(patterns.count(), grid.knots());
  Eigen::MatrixXf along = Eigen::MatrixXf::Zero(patterns.count(), grid.cols);
  std::size_t j = 0;
  while (j < support.pixels.size()) {
    const std::int32_t row = support.pixels[j] / plane_cols;
    int first = grid.cols, last = -1;
    for (; j < support.pixels.size() && support.pixels[j] / plane_cols == row; ++j) {
      if (envelope[j] == 0.0) continue;
      const SplinesAt across = splines_at(support.pixels[j] % plane_cols, grid.first_col_px, grid.pitch_px, grid.cols);
      for (int v = 0; v < across.count; ++v) {
        along.col(across.first + v) += static_cast<float>(envelope[j] * across.value[static_cast<std::size_t>(v)]) *
                                       patterns.pixel(support.pixels[j]);
      }
      first = std::min(first, across.first);
      last = std::max(last, across.first + across.count - 1);
    }
    const SplinesAt down = splines_at(row, grid.first_row_px, grid.pitch_px, grid.rows);
    for (int v = first; v <= last; ++v) {
      for (int u = 0; u < down.count; ++u) {
        signals.col((down.first + u) * grid.cols + v) +=
            static_cast<float>(down.value[static_cast<std::size_t>(u)]) * along.col(v);
      }
      along.col(v).setZero();
    }
  }
  return signals;
}

/// So that squares / (1 + factor row_variance) have a mean of one; what few points scatter by anyway is no reason.
double inflation(const Eigen::ArrayXd& squares, const Eigen::ArrayXd& row_variance) {
  const auto surplus = [&](double factor) { return (squares / (1.0 + factor * row_variance) - 1.0).sum(); };
  if (surplus(1.0) <= by_chance * std::sqrt(2.0 * static_cast<double>(squares.size()))) return 1.0;
  double lo = 1.0, hi = 2.0;
  while (surplus(hi) > 0.0 && hi < 1e6) hi *= 2.0;
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (lo + hi);
    (surplus(middle) > 0.0 ? lo : hi) = middle;
  }
  return hi;
}

Eigen::MatrixXd squared_sums(const Eigen::MatrixXd& slopes) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(slopes.cols(), slopes.cols());
  normal.selfadjointView<Eigen::Lower>().rankUpdate(slopes.transpose());
  return normal;
}

}  // namespace

FieldSystem::FieldSystem(const ConeFit& fit, const RowSupport& support, const KnotGrid& grid,
                         const ShownPatterns& patterns, const RowSamples& samples, const ConePrior& prior,
                         int plane_cols)
    : fitted_(patterns.fitted()), certainty_(fit.certainty) {
  std::array<Eigen::MatrixXf, field_kinds> signals;
  int columns = cone_parameters;
  for (std::size_t f = 0; f < field_kinds; ++f) {
    begin_[f] = columns;
    signals[f] = knot_signals(support, support.envelope[f], grid, patterns, plane_cols);
    const Eigen::VectorXf sizes = signals[f].colwise().norm();
    const float least = static_cast<float>(least_signal) * sizes.maxCoeff();
    for (Eigen::Index knot = 0; knot < sizes.size(); ++knot) place_[f].push_back(sizes[knot] > least ? columns++ : -1);
  }
  begin_[field_kinds] = columns;
  slopes_.resize(patterns.count(), columns);
  slopes_.leftCols(cone_parameters) = cone_slopes(patterns, fit.row, fit.cone.gain);
  for (std::size_t f = 0; f < field_kinds; ++f) {
    for (std::size_t knot = 0; knot < place_[f].size(); ++knot) {
      if (place_[f][knot] < 0) continue;
      slopes_.col(place_[f][knot]) = signals[f].col(static_cast<Eigen::Index>(knot)).cast<double>();
    }
  }
  slopes_ = certainty_.asDiagonal() * slopes_;
  off_ = (samples.light - fit.predicted).cwiseProduct(certainty_);
  const auto judging = patterns.count() - fitted_;
  normal_fitted_ = squared_sums(slopes_.topRows(fitted_));
  normal_all_ = normal_fitted_ + squared_sums(slopes_.bottomRows(judging));
  right_fitted_ = slopes_.topRows(fitted_).transpose() * off_.head(fitted_);
  right_all_ = right_fitted_ + slopes_.bottomRows(judging).transpose() * off_.tail(judging);
  const ConeMatrix alone =
      ConeMatrix(normal_fitted_.topLeftCorner<cone_parameters, cone_parameters>().selfadjointView<Eigen::Lower>()) +
      ConeMatrix(deviations(prior).cwiseAbs2().cwiseInverse().asDiagonal());
  const double tilt = most_tilt * fit.cone.half_angle_rad;
  most_ << tilt, tilt, most_half, most_order, most_gain;
  const ConeVector deviation = (most_deviations * alone.inverse().diagonal().cwiseSqrt()).cwiseMin(most_);
  cone_precision_ = deviation.cwiseAbs2().cwiseInverse();
}

FieldSystem::Unknowns FieldSystem::unknowns(const FieldStrengths& strengths) const {
  Unknowns found;
  for (int c = 0; c < cone_parameters; ++c) found.index.push_back(c);
  for (std::size_t f = 0; f < field_kinds; ++f) {
    for (int c = begin_[f]; c < begin_[f + 1] && strengths[f] > 0.0; ++c) found.index.push_back(c);
  }
  const auto count = static_cast<Eigen::Index>(found.index.size());
  found.precision.resize(count);
  found.precision.head<cone_parameters>() = cone_precision_;
  for (Eigen::Index c = cone_parameters; c < count; ++c) {
    std::size_t f = 0;
    while (found.index[static_cast<std::size_t>(c)] >= begin_[f + 1]) ++f;
    found.precision[c] = 1.0 / (strengths[f] * strengths[f]);
  }
  return found;
}

// Where samples pull the cone far beside what its prior allows (dust under a hard edge, that no order of the profile
// explains), a straight line has nothing to say of it: there it stays as fitted alone.
FieldSystem::Settled FieldSystem::settled(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right,
                                          const Unknowns& of) const {
  Settled found;
  Eigen::VectorXd precision = of.precision;
  for (int attempt = 0; attempt < 2; ++attempt) {
    Eigen::MatrixXd with_prior = normal(of.index, of.index);
    with_prior.diagonal() += precision;
    found.factor.compute(with_prior);
    found.mean = found.factor.solve(Eigen::VectorXd(right(of.index)));
    const auto far = (found.mean.head<cone_parameters>().array().abs() > 2.0 * most_.array()).eval();
    if (!far.any()) break;
    for (int c = 0; c < cone_parameters; ++c) precision[c] *= far[c] ? standing_still : 1.0;
  }
  return found;
}

FieldSystem::Score FieldSystem::score(const FieldStrengths& strengths) const {
  const Unknowns of = unknowns(strengths);
  const Settled fit = settled(normal_fitted_, right_fitted_, of);
  const auto judging = slopes_.rows() - fitted_;
  Eigen::MatrixXd spread = slopes_.bottomRows(judging)(Eigen::all, of.index).transpose();
  const Eigen::ArrayXd squares = (off_.tail(judging) - spread.transpose() * fit.mean).array().square();
  fit.factor.matrixL().solveInPlace(spread);
  const Eigen::ArrayXd row_variance = spread.colwise().squaredNorm().transpose().array();
  Score score;
  const auto points = static_cast<double>((certainty_.tail(judging).array() > 0.0).count());
  score.chi2 = squares.sum() / std::max(points, 1.0);
  score.log_likelihood = -0.5 * (squares / (1.0 + row_variance) + (1.0 + row_variance).log()).sum();
  score.inflation = inflation(squares, row_variance);
  return score;
}

FieldSystem::Solution FieldSystem::solve(const FieldStrengths& strengths, bool of_twice) const {
  const Unknowns of = unknowns(strengths);
  Settled fit = settled(normal_all_, right_all_, of);
  Solution found;
  found.mean = std::move(fit.mean);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(found.mean.size(), found.mean.size());
  found.covariance = fit.factor.solve(identity);
  if (of_twice) {
    found.covariance_of_twice = settled(2.0 * normal_all_, 2.0 * right_all_, of).factor.solve(identity);
  }
  std::vector<int> at(static_cast<std::size_t>(slopes_.cols()), -1);
  for (std::size_t c = 0; c < of.index.size(); ++c) at[static_cast<std::size_t>(of.index[c])] = static_cast<int>(c);
  for (std::size_t f = 0; f < field_kinds; ++f) {
    for (const int column : place_[f]) {
      found.place[f].push_back(column < 0 ? -1 : at[static_cast<std::size_t>(column)]);
    }
  }
  return found;
}

}  // namespace compueye::calib
