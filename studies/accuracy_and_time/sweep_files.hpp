#pragma once

#include <string>

#include "firmware/operating_points/measured_points.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// Every figure; for people a table of the efficient points for each noise level and overall, and how to read it.
[[nodiscard]] Figures sweep_report(const Sweep& sweep);

/// A header line, then a line for every point at every noise level and one for it overall, and the conventional eye;
/// RFC 4180.
[[nodiscard]] std::string sweep_csv(const Sweep& sweep);

/// The name of a level's plots without their ending, "pareto-noise-4".
[[nodiscard]] std::string plot_stem(const NoiseLevel& level);

/// An SVG and a PNG for every noise level, drawn by gnuplot, and the script beside them for whoever wants another
/// font. False: gnuplot is not installed, and there are only the scripts. Errors: io when gnuplot fails, those of
/// AtomicFile.
[[nodiscard]] hal::Result<bool> write_plots(const std::string& folder, const Sweep& sweep);

}  // namespace compueye::firmware
