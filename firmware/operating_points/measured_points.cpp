#include "firmware/operating_points/measured_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "recon/setup/factor.hpp"
#include "recon/setup/solver_row.hpp"

namespace compueye::firmware {
namespace {

/// `worst_last` sorted.
double nine_in_ten_of(const std::vector<double>& worst_last) {
  const std::size_t rank = (worst_last.size() * 9 + 9) / 10;
  return worst_last[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

std::span<const recon::Named<Motion>> motion_names() noexcept {
  static constexpr std::array<recon::Named<Motion>, 3> names{
      {{"none", Motion::none}, {"still", Motion::still}, {"sprite", Motion::sprite}}};
  return names;
}

std::string_view name(Motion motion) noexcept {
  return motion_names()[static_cast<std::size_t>(motion)].name;
}

std::string title(const Curve& curve) {
  std::string text(recon::name(curve.solver));
  if (!curve.solver->direct) {
    text += ' ';
    text += recon::name(curve.basis);
  }
  if (curve.precision == recon::Precision::f64) text += " f64";
  if (curve.op) text += ", " + std::string(recon::name(*curve.op));
  if (curve.threads > 1) text += fmt::format(", {} threads", curve.threads);
  return curve.motion == Motion::none ? text : text + ", warm, " + std::string(name(curve.motion));
}

Board with_curve(const Board& board, const Curve& curve) {
  Board other = board;
  other.plan.solver = curve.solver;
  other.plan.precision = curve.precision;
  other.plan.op = curve.op;
  other.plan.warm_start = curve.motion != Motion::none;
  other.plan.threads = curve.threads;
  other.objective.basis = curve.basis;
  other.objective.constraint = curve.constraint;
  // Both were chosen for the board's own solver and basis; rho means the same where solver and metric are the same.
  other.lambda = std::nullopt;
  if (curve.solver != board.plan.solver || recon::metric_of(curve.basis) != recon::metric_of(board.objective.basis)) {
    other.plan.rho = 0.0;
  }
  return other;
}

QualitySummary summarise(std::span<const PictureQuality> pictures) {
  QualitySummary summary;
  const auto fill = [&](double PictureQuality::*figure, bool more_is_better) {
    std::vector<double> values;
    for (const PictureQuality& picture : pictures) values.push_back(picture.*figure);
    summary.mean.*figure = std::accumulate(values.begin(), values.end(), 0.0) /
                           static_cast<double>(std::max<std::size_t>(values.size(), 1));
    std::sort(values.begin(), values.end());
    if (more_is_better) std::reverse(values.begin(), values.end());
    if (!values.empty()) summary.nine_in_ten.*figure = nine_in_ten_of(values);
  };
  fill(&PictureQuality::nmse, false);
  fill(&PictureQuality::psnr_db, true);
  fill(&PictureQuality::ssim, true);
  return summary;
}

std::vector<std::size_t> efficient_front(std::span<const CostAndError> points, double least_gain) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isfinite(points[i].cost) && std::isfinite(points[i].error)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (!(points[i].error < least * (1.0 - least_gain))) continue;
    least = points[i].error;
    front.push_back(i);
  }
  return front;
}

std::vector<std::size_t> efficient_points(const Sweep& sweep, std::size_t level, double MeasuredPoint::*cost) {
  constexpr double least_gain = 0.01;
  std::vector<CostAndError> points;
  for (const MeasuredPoint& point : sweep.points) {
    const QualitySummary& quality = level < point.levels.size() ? point.levels[level].quality : point.overall;
    const bool counts = point.curve.motion != Motion::still;
    points.push_back({point.*cost, counts ? quality.mean.nmse : std::numeric_limits<double>::quiet_NaN()});
  }
  return efficient_front(points, least_gain);
}

}  // namespace compueye::firmware
