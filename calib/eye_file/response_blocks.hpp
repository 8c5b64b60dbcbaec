#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/estimate_check.hpp"
#include "calib/eye_file/eye_records.hpp"

namespace compueye::calib {

/// Stores all rows, some 2^18 entries to a block: the hash of each. Error out_of_range: an entry beyond float32, or a
/// sigma that is negative or not finite.
[[nodiscard]] hal::Result<std::vector<std::int64_t>> store_blocks(const Database& database, std::int64_t estimate,
                                                                  const recon::Response& response,
                                                                  std::span<const float> sigma);

/// The hashes that the blocks say they have, in order.
[[nodiscard]] hal::Result<std::vector<std::int64_t>> load_block_hashes(const Database& database, std::int64_t estimate);

/// Error bad_format: a block that does not match its hash, or blocks that are not this shape's.
[[nodiscard]] hal::Result<MeasuredResponse> load_blocks(const Database& database, std::int64_t estimate,
                                                        const ResponseShape& shape);

}  // namespace compueye::calib
