#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/eye_records.hpp"
#include "calib/eye_file/record_digest.hpp"

namespace compueye::calib {

/// Errors mismatch, out_of_range: what is to be stored makes no sense for an eye of this many ommatidia.
[[nodiscard]] hal::Result<void> check_capture(const std::string& path, const Capture& capture, int ommatidia);
[[nodiscard]] hal::Result<void> store_capture(const Database& database, std::int64_t session, std::int64_t position,
                                              const Capture& capture);

[[nodiscard]] hal::Result<std::int64_t> count_captures(const Database& database, std::int64_t session);

/// The capture at a position, its hash added to `raw`; nothing where there is none. Error bad_format: its hash does not
/// match.
[[nodiscard]] hal::Result<std::optional<Capture>> load_capture(const Database& database, std::int64_t session,
                                                               std::int64_t position, RecordDigest& raw);
/// Adds the hashes of all captures of a session, as load_capture() does.
[[nodiscard]] hal::Result<void> add_capture_hashes(const Database& database, std::int64_t session, RecordDigest& raw);

}  // namespace compueye::calib
