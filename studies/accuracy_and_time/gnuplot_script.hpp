#pragma once

#include <cstddef>
#include <string>

#include "studies/accuracy_and_time/sweep.hpp"

namespace compueye::firmware {

/// What gnuplot is told for one noise level: it writes `stem`.svg.partial and `stem`.png.partial into its folder. Mean
/// NMSE over median time, both on logarithmic axes; the efficient front behind the curves, with a whisker to the 99.9th
/// percentile; the conventional eye as a line.
[[nodiscard]] std::string gnuplot_script(const Sweep& sweep, std::size_t level, const std::string& stem);

}  // namespace compueye::firmware
