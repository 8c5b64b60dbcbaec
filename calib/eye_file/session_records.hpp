#pragma once

#include <cstdint>
#include <vector>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/eye_records.hpp"

namespace compueye::calib {

/// Errors out_of_range, mismatch: what is to be stored makes no sense.
[[nodiscard]] hal::Result<std::int64_t> store_session(const Database& database, const Session& session);
/// Errors: not_found, bad_format (its hash does not match).
[[nodiscard]] hal::Result<StoredSession> load_session(const Database& database, std::int64_t id);
[[nodiscard]] hal::Result<std::vector<StoredSession>> load_sessions(const Database& database);
[[nodiscard]] hal::Result<void> store_session_end(const Database& database, StoredSession session, SessionEnd end);

}  // namespace compueye::calib
