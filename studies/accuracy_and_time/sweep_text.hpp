#pragma once

#include <string>

#include "studies/accuracy_and_time/sweep.hpp"

namespace compueye::firmware {

/// A table of the efficient points for each noise level and overall, and how to read it.
[[nodiscard]] std::string sweep_text(const Sweep& sweep);

/// A header line, then a line for every point at every noise level and one for it overall, and the conventional eye;
/// RFC 4180.
[[nodiscard]] std::string sweep_csv(const Sweep& sweep);

}  // namespace compueye::firmware
