#pragma once

#include <cstdint>
#include <string>

#include "calib/eye_file/eye_records.hpp"

namespace compueye::calib {

/// Shape of a response of which a file has the entries.
struct ResponseShape {
  int rows = 0, cols = 0;
  int image_rows = 0, image_cols = 0;
  bool dense = false;
  std::int64_t entries = 0;
};

/// Whether all parts of an estimate fit an eye of this many ommatidia. Errors: mismatch (a length), out_of_range (a
/// number that is not finite, sessions out of order, counts below 0).
[[nodiscard]] hal::Result<void> check_estimate(const std::string& path, const Estimate& estimate, int ommatidia);

/// Whether such a response is one of an eye of this many ommatidia, and has one sigma an entry or none.
[[nodiscard]] hal::Result<void> check_shape(const std::string& path, const ResponseShape& shape, std::size_t sigmas,
                                            int ommatidia);

}  // namespace compueye::calib
