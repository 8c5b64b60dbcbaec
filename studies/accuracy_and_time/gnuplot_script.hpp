#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware/operating_points/measured_points.hpp"

namespace compueye::firmware {

/// A curve as a plot shows it.
struct PlotCurve {
  std::string title;
  std::vector<std::size_t> points;  ///< indices into Sweep::points, by iterations
  bool named = false;               ///< in its own colour and in the legend; the others are grey
};

inline constexpr std::size_t most_named_curves = 8;

/// Every curve of the sweep, those first that have most efficient points at `level` and then those that come nearest:
/// the first few are named, because more colours than eyes can tell apart name nothing.
[[nodiscard]] std::vector<PlotCurve> plot_curves(const Sweep& sweep, std::size_t level);

/// What gnuplot is told for one noise level: it writes `stem`.svg.partial and `stem`.png.partial into its folder. Mean
/// NMSE over median time, both on logarithmic axes; the efficient front behind the curves, with a whisker to the 99.9th
/// percentile; the conventional eye as a line.
[[nodiscard]] std::string gnuplot_script(const Sweep& sweep, std::size_t level, const std::string& stem);

}  // namespace compueye::firmware
