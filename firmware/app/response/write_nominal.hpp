#pragma once

#include <optional>
#include <string>

#include "hal/result.hpp"

namespace compueye::firmware {

/// The command line of `compueye response`.
struct ResponseOptions {
  std::string board;
  std::string out;                    ///< .mtx or .npy; empty: only the figures
  std::optional<double> distance_mm;  ///< absent: the board's
  bool json = false;
};

/// `compueye response`: the response that a board's geometry gives, as a file, and its figures on stdout.
[[nodiscard]] hal::Result<void> write_nominal(const ResponseOptions& options);

}  // namespace compueye::firmware
