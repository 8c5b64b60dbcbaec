#pragma once

#include <string>

#include "calib/eye_file/database.hpp"

namespace compueye::calib {

/// Makes an empty file at `path`, known to the disk by its name: whether there was none before. Errors: not_found, io.
[[nodiscard]] hal::Result<bool> make_file(const std::string& path);
[[nodiscard]] tl::unexpected<hal::Error> already_there(const std::string& path);
/// Whether there is nothing in it, as where its making was cut off.
[[nodiscard]] hal::Result<bool> has_nothing(const Database& database);

/// Whether there is something at `path` that may be an eye file. Errors: not_found, io (a folder, no regular file),
/// bad_format (empty).
[[nodiscard]] hal::Result<void> check_file(const std::string& path);

/// Opens a file that is there and, for writing, takes the lock that is held until it is closed. Looks at no table.
/// Errors: io (read-only, in use), bad_format.
[[nodiscard]] hal::Result<Database> open_database(const std::string& path, bool for_writing);

/// Makes every table in an empty database. Inside a transaction.
[[nodiscard]] hal::Result<void> make_schema(const Database& database);
/// Whether it is an eye file of this version, table for table. Errors: bad_format, unsupported (a newer version).
[[nodiscard]] hal::Result<void> check_schema(const Database& database);

/// From one file to one with a log beside it, which every commit flushes to the disk.
[[nodiscard]] hal::Result<void> start_log(const Database& database);
/// And back.
[[nodiscard]] hal::Result<void> end_log(const Database& database);

}  // namespace compueye::calib
