#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/result.hpp"

namespace compueye::firmware {

/// The command line of `compueye response`.
struct ResponseOptions {
  std::string board;
  std::string out;                    ///< .mtx or .npy; empty: only the figures
  std::optional<double> distance_mm;  ///< absent: the board's
  /// Seed of a calib::plausible_response(); absent: the nominal one.
  std::optional<std::uint64_t> as_measured;
  bool json = false;
};

/// `compueye response`: the response that a board's geometry gives, or one as a calibration of such an eye might find
/// it, as a file, and its figures on stdout.
[[nodiscard]] hal::Result<void> write_nominal(const ResponseOptions& options);

}  // namespace compueye::firmware
