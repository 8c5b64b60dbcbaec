#pragma once

#include <string>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/eye_records.hpp"

namespace compueye::calib {

/// Errors out_of_range of the geometry and the plane, at `path`.
[[nodiscard]] hal::Result<void> check_eye(const std::string& path, const EyeIdentity& eye);
[[nodiscard]] hal::Result<void> store_eye(const Database& database, const EyeIdentity& eye);
/// Error bad_format: none, or not as it was stored.
[[nodiscard]] hal::Result<EyeIdentity> load_eye(const Database& database);

}  // namespace compueye::calib
