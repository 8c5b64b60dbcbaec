#include "calib/estimate/row_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "calib/estimate/entry_gradient.hpp"
#include "calib/estimate/row_error_sum.hpp"

namespace compueye::calib {
namespace {

constexpr std::size_t most_tried = 3;
/// Of the roughness of a field at its knots, rms: what coverage of simulated eyes asks for (docs/calibration.md).
constexpr double hidden_share = 0.02, hidden_at_px = 4.0;
/// Rows whose errors are told by kind, about: it costs as much as their entries.
constexpr int most_telling = 512;

/// Variance of what a field hides between its knots, where no blob shows it: it is taken to be as rough as the field
/// itself is from one knot to its neighbours, in the share that `hidden_share` says.
double hidden_variance(const std::vector<float>& field, const KnotGrid& grid) {
  if (field.empty()) return 0.0;
  double squares = 0.0, knots = 0.0;
  for (int u = 1; u + 1 < grid.rows; ++u) {
    for (int v = 1; v + 1 < grid.cols; ++v) {
      const float* at = field.data() + u * grid.cols + v;
      const double around = 0.25 * static_cast<double>(at[-1] + at[1] + at[-grid.cols] + at[grid.cols]);
      squares += (static_cast<double>(*at) - around) * (static_cast<double>(*at) - around);
      knots += 1.0;
    }
  }
  const double share = hidden_share * grid.pitch_px / hidden_at_px;
  return share * share * squares / std::max(knots, 1.0);
}

/// By the cone's parameters but the gain, which is left out: only the direction counts.
std::array<double, ConeRow::changes> changes_at(const RowSupport& support, std::size_t j) {
  std::array<double, ConeRow::changes> changes{};
  const std::int32_t in_cone = support.in_cone[j];
  for (std::size_t d = 0; d < changes.size() && in_cone >= 0; ++d) {
    changes[d] = support.cone.change[d][static_cast<std::size_t>(in_cone)];
  }
  return changes;
}

}  // namespace

StrengthsTried StrengthsTried::none() {
  StrengthsTried tried;
  tried.strengths.push_back(field_strengths().front());
  tried.log_shares.push_back(0.0);
  return tried;
}

StrengthsTried StrengthsTried::commonest(const std::vector<std::vector<double>>& log_likelihoods) {
  const std::vector<double> shares = calib::log_shares(log_likelihoods);
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin() + 1, order.end(), [&](std::size_t a, std::size_t b) { return shares[a] > shares[b]; });
  StrengthsTried tried;
  for (std::size_t k = 0; k <= most_tried && k < order.size(); ++k) {
    tried.strengths.push_back(field_strengths()[order[k]]);
    tried.log_shares.push_back(shares[order[k]]);
  }
  return tried;
}

RowEstimator::Start RowEstimator::start(int channel) {
  const int i = channel / model_.eye().columns, k = channel % model_.eye().columns;
  Start from;
  from.samples = row_samples(task_.samples, task_.patterns, channel);
  from.fit = fit_cone(model_, i, k, task_.plane, task_.patterns, from.samples, task_.prior);
  from.support = support_of(model_, i, k, from.fit.cone, task_.plane);
  if (from.support.pixels.empty()) return from;
  from.grid =
      KnotGrid::over(from.support.pixels, model_.plane().cols, task_.settings.pitch_px, task_.settings.most_knots);
  return from;
}

FieldSystem RowEstimator::system(const Start& from) const {
  return {from.fit, from.support, from.grid, task_.patterns, from.samples, task_.prior, model_.plane().cols};
}

std::vector<double> RowEstimator::score(int channel) {
  const Start from = start(channel);
  std::vector<double> all;
  if (from.support.pixels.empty()) return all;
  const FieldSystem fields = system(from);
  for (const FieldStrengths& strengths : field_strengths()) all.push_back(fields.score(strengths).log_likelihood);
  return all;
}

// The misfit that noise explains does not count, however large it is beside a faint signal.
bool RowEstimator::fits(const Start& from, double chi2) const {
  const StatusLimits& limits = task_.settings.limits;
  if (!(chi2 > limits.misfit_chi2)) return true;
  const auto judging = task_.patterns.count() - task_.patterns.fitted();
  const Eigen::ArrayXd light = from.samples.light.tail(judging).array();
  const double spread = (light - light.mean()).square().mean();
  const double noise = from.fit.certainty.tail(judging).array().square().mean();
  return chi2 / noise <= limits.misfit_share * limits.misfit_share * spread;
}

RowEstimate RowEstimator::estimate(int channel, const StrengthsTried& tried) {
  RowEstimate row;
  const Start from = start(channel);
  row.parameters.cone = from.fit.cone;
  if (from.support.pixels.empty()) {
    row.status = ChannelStatus::does_not_fit;
    return row;
  }
  row.parameters.grid = from.grid;
  const FieldSystem fields = system(from);
  choose(fields, tried, row);
  if (!fits(from, row.held_out_chi2)) {
    row.status = ChannelStatus::does_not_fit;
    return row;
  }
  fill(channel, fields.solve(row.strengths, tells_errors(channel)), row);
  return row;
}

// What a field's strength is expected to be, squared: of strengths that the patterns cannot tell apart none is wholly
// right, and the sigmas of one alone would be too small.
void RowEstimator::choose(const FieldSystem& fields, const StrengthsTried& tried, RowEstimate& row) {
  std::vector<FieldSystem::Score> scores;
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < tried.strengths.size(); ++k) {
    scores.push_back(fields.score(tried.strengths[k]));
    scores.back().log_likelihood += tried.log_shares[k];
    best = std::max(best, scores.back().log_likelihood);
  }
  double sum = 0.0, chi2 = 0.0, inflation = 0.0;
  FieldStrengths squares{};
  for (std::size_t k = 0; k < scores.size(); ++k) {
    const double share = std::exp(scores[k].log_likelihood - best);
    sum += share;
    chi2 += share * scores[k].chi2;
    inflation += share * scores[k].inflation;
    for (std::size_t f = 0; f < field_kinds; ++f) squares[f] += share * tried.strengths[k][f] * tried.strengths[k][f];
  }
  for (std::size_t f = 0; f < field_kinds; ++f) row.strengths[f] = std::sqrt(squares[f] / sum);
  row.held_out_chi2 = chi2 / sum;
  row.inflation = std::sqrt(inflation / sum);
}

bool RowEstimator::tells_errors(int channel) const noexcept {
  return channel % (1 + model_.eye().ommatidia() / most_telling) == 0;
}

void RowEstimator::fill(int channel, const FieldSystem::Solution& solution, RowEstimate& row) {
  RowParameters& parameters = row.parameters;
  const ConeParameters drawn = model_.drawn();
  parameters.cone = departed(drawn, departure(parameters.cone, drawn) + solution.mean.head<cone_parameters>());
  for (std::size_t f = 0; f < field_kinds; ++f) {
    if (row.strengths[f] == 0.0) continue;
    for (const int place : solution.place[f]) {
      parameters.field[f].push_back(place < 0 ? 0.0F : static_cast<float>(solution.mean[place]));
    }
  }
  for (int c = 0; c < cone_parameters; ++c) {
    row.parameter_sigma[static_cast<std::size_t>(c)] = row.inflation * std::sqrt(solution.covariance(c, c));
  }
  const int columns = model_.eye().columns, plane_cols = model_.plane().cols;
  const RowSupport support = support_of(model_, channel / columns, channel % columns, parameters.cone, task_.plane);
  const std::vector<double> entries = entries_of(parameters, support, plane_cols);
  std::array<double, field_kinds> hidden{};
  for (std::size_t f = 0; f < field_kinds; ++f) hidden[f] = hidden_variance(parameters.field[f], parameters.grid);
  RowErrorSum errors;
  const bool telling = solution.covariance_of_twice.size() > 0;
  for (std::size_t j = 0; j < entries.size(); ++j) {
    if (!(entries[j] > least_entry)) continue;
    EntryGradient gradient = gradient_of(support, j, parameters, solution, plane_cols);
    RowErrorSum::Entry entry{entries[j], changes_at(support, j), 0.0};
    for (std::size_t f = 0; f < field_kinds; ++f) {
      entry.hidden_variance += hidden[f] * support.envelope[f][j] * support.envelope[f][j];
    }
    const double variance = gradient.variance(solution.covariance) + entry.hidden_variance;
    row.columns.push_back(support.pixels[j]);
    row.values.push_back(static_cast<float>(entries[j]));
    row.sigmas.push_back(static_cast<float>(row.inflation * std::sqrt(variance)));
    if (telling) errors.add(entry, std::move(gradient));
  }
  if (telling) row.errors = errors.errors(solution.covariance, solution.covariance_of_twice);
}

}  // namespace compueye::calib
