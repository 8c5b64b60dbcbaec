#pragma once

#include <filesystem>
#include <string>

#include "hal/result.hpp"
#include "studies/accuracy_and_time/sweep.hpp"

namespace compueye::firmware {

/// The name of a level's plots without their ending, "pareto-noise-4".
[[nodiscard]] std::string plot_stem(const NoiseLevel& level);

/// An SVG and a PNG for every noise level, drawn by gnuplot, and the script beside them for whoever wants another
/// font. Without gnuplot a sentence on stderr and no pictures. Errors: io when gnuplot fails, those of AtomicFile.
[[nodiscard]] hal::Result<void> write_plots(const std::filesystem::path& folder, const Sweep& sweep);

}  // namespace compueye::firmware
