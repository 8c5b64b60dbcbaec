#pragma once

#include <string>

#include "firmware/text/figures.hpp"
#include "studies/stability/stability.hpp"

namespace compueye::firmware {

/// Every figure; for people a table with a line a case, what failed safe and how, and how to read it.
[[nodiscard]] Figures stability_report(const Stability& stability);

/// A header line, then a line a run; RFC 4180.
[[nodiscard]] std::string stability_csv(const Stability& stability);

/// What gnuplot is told: accuracy over the condition of the case, float32 beside double, and what failed safe above.
[[nodiscard]] std::string stability_plot(const Stability& stability, const std::string& stem);

}  // namespace compueye::firmware
