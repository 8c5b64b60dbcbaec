#pragma once

#include <cstdint>

#include "recon/problem/response.hpp"

namespace compueye::calib {

/// What a calibrator wants to know of a response before trusting it. A row's support is the number of pixels it sees.
struct ResponseSummary {
  int ommatidia = 0;          ///< M
  int blind_rows = 0;         ///< rows with empty support
  std::int64_t entries = 0;   ///< entries above the floor
  int support_min = 0;        ///< over the seeing rows; all three 0 when every row is blind
  double support_median = 0;  ///< mean of the two middle ones when their number is even
  int support_max = 0;        ///<
  int pixels = 0;             ///< N
  int seen_pixels = 0;        ///< pixels that at least one row sees
  int most_seen = 0;          ///< rows that see the most-seen pixel

  [[nodiscard]] int seeing_rows() const noexcept { return ommatidia - blind_rows; }
  [[nodiscard]] int unseen_pixels() const noexcept { return pixels - seen_pixels; }
};

/// Counts entries with a magnitude above `floor` (>= 0): 0 for a nominal response, the noise floor for a measured one.
[[nodiscard]] ResponseSummary summarise(const recon::Response& response, double floor = 0.0);

}  // namespace compueye::calib
