#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/estimate_check.hpp"
#include "calib/eye_file/eye_records.hpp"

namespace compueye::calib {

/// An estimate and what seals it, but not its rows.
struct EstimateRecord {
  std::int64_t id = 0;
  std::uint64_t raw_hash = 0;
  ResponseShape shape;
  Estimate estimate;
};

/// Stores all of it; `block_hashes` are those of its response's rows, stored before or after.
[[nodiscard]] hal::Result<void> store_record(const Database& database, const EstimateRecord& record,
                                             std::span<const std::int64_t> block_hashes);

/// Errors: not_found; bad_format (its hash, over all its parts and the hashes of the blocks, does not match).
[[nodiscard]] hal::Result<EstimateRecord> load_record(const Database& database, std::int64_t id);

/// Ascending.
[[nodiscard]] hal::Result<std::vector<std::int64_t>> record_ids(const Database& database);

}  // namespace compueye::calib
