#pragma once

#include <cstdint>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/eye_records.hpp"
#include "calib/eye_file/record_digest.hpp"

/// The lists of numbers and columns of an estimate: tables estimate_number and estimate_column.
namespace compueye::calib {

void add_parts(RecordDigest& digest, const Estimate& estimate);
[[nodiscard]] hal::Result<void> store_parts(const Database& database, std::int64_t id, const Estimate& estimate);
[[nodiscard]] hal::Result<void> load_parts(const Database& database, std::int64_t id, Estimate& estimate);

}  // namespace compueye::calib
