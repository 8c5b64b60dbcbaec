#include "studies/accuracy_and_time/gnuplot_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "firmware/text/number_text.hpp"
#include "studies/plots/gnuplot.hpp"

namespace compueye::firmware {
namespace {

/// Nought has no place on a logarithmic axis.
double drawable(double nmse) {
  constexpr double least = 1e-9;
  return std::max(nmse, least);
}

std::string rows_of(const Sweep& s, const std::vector<std::size_t>& points, std::size_t level) {
  std::string text;
  for (const std::size_t i : points) {
    const MeasuredPoint& p = s.points[i];
    text +=
        fmt::format("{} {} {} {}\n", p.median_ms, drawable(p.levels[level].quality.mean.nmse), p.p999_ms, p.iterations);
  }
  return text;
}

std::string axes_of(const Sweep& s, std::size_t level) {
  constexpr double worst_shown = 2.0;  // far above a black picture nothing is worth comparing
  double fast = s.points.front().median_ms, slow = fast, best = worst_shown, worst = 0.0;
  for (const MeasuredPoint& p : s.points) {
    const double nmse = drawable(p.levels[level].quality.mean.nmse);
    fast = std::min(fast, p.median_ms);
    slow = std::max(slow, p.median_ms);
    best = std::min(best, nmse);
    worst = std::max(worst, nmse);
  }
  if (level < s.conventional.size()) worst = std::max(worst, drawable(s.conventional[level].mean.nmse));
  return log_axis('x', fast, slow) + log_axis('y', best, std::min(worst, worst_shown));
}

std::string head_of(const Sweep& s, std::size_t level) {
  const std::string first = fmt::format("{}: what accuracy costs in time", s.board);
  const std::string second =
      fmt::format("{} scenes ({}), noise {} white pixels = {:g} x the board's", s.pictures_a_level,
                  fmt::join(s.scenes, ", "), significant(s.levels[level].sigma, 3), s.levels[level].times);
  const std::string third = fmt::format("{}, one core where no threads are named", s.machine.cpu);
  return fmt::format("set title {}.\"\\n\".{}.\"\\n\".{} noenhanced\n", quoted_for_plot(first), quoted_for_plot(second),
                     quoted_for_plot(third)) +
         "set logscale xy\n" + axes_of(s, level) +
         "set xlabel 'median time of a frame (ms)'\n"
         "set ylabel 'mean NMSE (1 = a black picture)'\n"
         "set grid xtics ytics lc rgb '#d8d8d8' lw 0.8\n"
         "set key outside right top vertical Left reverse noenhanced spacing 1.15 samplen 2.5\n"
         "set border lc rgb '#606060'\n"
         "set tics nomirror\n";
}

std::string plots_of(const Sweep& s, std::size_t level, const std::vector<PlotCurve>& curves) {
  std::string text =
      "plot $front using 1:2 with steps lw 9 lc rgb '#d9d3f0' title 'efficient front', \\\n"
      "  $front using 1:2:1:3 with xerrorbars pt 0 lw 1 lc rgb '#8878c8' title 'to the 99.9th percentile'";
  if (level < s.conventional.size())
    text += ", \\\n  conventional with lines dt 2 lw 2 lc rgb '#606060' title 'conventional eye'";
  bool grey_titled = false;
  for (std::size_t c = curves.size(); c-- > 0;) {
    if (curves[c].named) continue;
    text += fmt::format(", \\\n  $c{} using 1:2 with linespoints pt 7 ps 0.4 lw 1 lc rgb '#b8b8b8' {}", c,
                        grey_titled ? "notitle" : "title 'every other curve'");
    grey_titled = true;
  }
  for (std::size_t c = 0; c < curves.size() && curves[c].named; ++c) {
    text += fmt::format(", \\\n  $c{} using 1:2 with linespoints pt {} ps 1.1 lw 2 lc rgb '{}' title {}", c,
                        plot_symbols[c], plot_colours[c], quoted_for_plot(curves[c].title));
  }
  return text + "\n";
}

struct Ranked {
  PlotCurve curve;
  std::size_t efficient = 0;
  double distance = std::numeric_limits<double>::infinity();  ///< least, in decades of time and NMSE together
};

double nmse_of(const Sweep& sweep, std::size_t i, std::size_t level) {
  return sweep.points[i].levels[level].quality.mean.nmse;
}

/// How far a point is from the nearest efficient one that outdoes it.
double distance_of(const Sweep& sweep, std::size_t i, const std::vector<std::size_t>& front, std::size_t level) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t f : front) {
    const double time = std::log10(sweep.points[i].median_ms / sweep.points[f].median_ms);
    const double error = std::log10(nmse_of(sweep, i, level) / nmse_of(sweep, f, level));
    const double distance = std::hypot(time, error);
    if (distance < least) least = distance;
  }
  return least;
}

}  // namespace

std::vector<PlotCurve> plot_curves(const Sweep& sweep, std::size_t level) {
  const std::vector<std::size_t> front = efficient_points(sweep, level);
  std::vector<Ranked> ranked;
  std::vector<Curve> kinds;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const Curve& kind = sweep.points[i].curve;
    const auto at = static_cast<std::size_t>(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
    if (at == kinds.size()) {
      kinds.push_back(kind);
      ranked.push_back({{title(kind), {}, false}});
    }
    ranked[at].curve.points.push_back(i);
    if (std::find(front.begin(), front.end(), i) != front.end()) ++ranked[at].efficient;
    ranked[at].distance = std::min(ranked[at].distance, distance_of(sweep, i, front, level));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    return a.efficient != b.efficient ? a.efficient > b.efficient : a.distance < b.distance;
  });
  std::vector<PlotCurve> curves;
  for (Ranked& one : ranked) {
    one.curve.named = curves.size() < most_named_curves;
    curves.push_back(std::move(one.curve));
  }
  return curves;
}

std::string gnuplot_script(const Sweep& sweep, std::size_t level, const std::string& stem) {
  const std::vector<PlotCurve> curves = plot_curves(sweep, level);
  std::string text = "$front << EOD\n" + rows_of(sweep, efficient_points(sweep, level), level) + "EOD\n";
  for (std::size_t c = 0; c < curves.size(); ++c) {
    text += fmt::format("$c{} << EOD\n", c) + rows_of(sweep, curves[c].points, level) + "EOD\n";
  }
  if (level < sweep.conventional.size()) {
    text += fmt::format("conventional = {}\n", drawable(sweep.conventional[level].mean.nmse));
  }
  text += head_of(sweep, level);
  return text + on_both_terminals(stem, plots_of(sweep, level, curves));
}

}  // namespace compueye::firmware
