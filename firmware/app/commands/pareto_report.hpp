#pragma once

#include <string>

#include "firmware/operating_points/measured_points.hpp"

namespace compueye::firmware {

/// A table of the efficient points for each noise level and overall, and how to read it.
[[nodiscard]] std::string sweep_text(const Sweep& sweep);

}  // namespace compueye::firmware
