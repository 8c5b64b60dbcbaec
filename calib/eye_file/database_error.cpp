#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>

#include "calib/eye_file/database.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;

struct Meaning {
  int result_code;  // with its extension, or without: then any extension
  ErrorCode code;
  std::string_view sentence;
};

constexpr std::string_view cut_off =
    "was left by a session that was cut off, and a reader cannot repair it; open it once for writing, in a folder that "
    "may be written (compueye calibrate --resume)";

// The first that fits; those with an extension come before theirs without.
constexpr std::array<Meaning, 15> meanings{{
    {SQLITE_READONLY_ROLLBACK, ErrorCode::io, cut_off},
    {SQLITE_READONLY_RECOVERY, ErrorCode::io, cut_off},
    {SQLITE_READONLY_CANTINIT, ErrorCode::io, cut_off},
    {SQLITE_READONLY, ErrorCode::io,
     "cannot be written: the file, its folder or its file system is read-only; check who owns it, or copy it to where "
     "it "
     "may be written"},
    {SQLITE_BUSY, ErrorCode::io,
     "is in use by another process, such as a running calibration; wait until that ends, or stop it"},
    {SQLITE_LOCKED, ErrorCode::io, "is in use elsewhere in this process; end that first"},
    {SQLITE_FULL, ErrorCode::no_space,
     "cannot be written: no space is left on the device; free some space and resume, nothing that was stored is lost"},
    {SQLITE_NOTADB, ErrorCode::bad_format, "is not an eye file: it is no SQLite database"},
    {SQLITE_CORRUPT, ErrorCode::bad_format, "is damaged or cut short; take a copy of it that is whole"},
    {SQLITE_NOMEM, ErrorCode::no_space, "does not fit into the memory of this machine"},
    {SQLITE_TOOBIG, ErrorCode::no_space, "would hold a record larger than SQLite can store (1 GB)"},
    {SQLITE_IOERR_NOMEM, ErrorCode::no_space, "does not fit into the memory of this machine"},
    {SQLITE_CANTOPEN, ErrorCode::io,
     "cannot be opened, or a file that SQLite needs beside it cannot; check the permissions of the file and its "
     "folder"},
    {SQLITE_PERM, ErrorCode::io, "cannot be opened: permission is denied; check who owns it"},
    {SQLITE_CONSTRAINT, ErrorCode::bad_format, "is not what its schema promises; take a copy of it that is whole"},
}};

}  // namespace

hal::Error database_error(const std::string& path, int result_code, sqlite3* database) {
  // A log that was left, and no leave to make the index that reading it takes.
  const bool log_is_there = !path.empty() && ::access((path + "-wal").c_str(), F_OK) == 0;
  if ((result_code & 0xFF) == SQLITE_CANTOPEN && log_is_there) result_code = SQLITE_READONLY_CANTINIT;
  const std::string place = path.empty() ? "eye file" : path;
  const auto found = std::find_if(meanings.begin(), meanings.end(), [&](const Meaning& meaning) {
    return meaning.result_code == result_code || meaning.result_code == (result_code & 0xFF);
  });
  if (found != meanings.end()) return {found->code, place, std::string(found->sentence)};
  if ((result_code & 0xFF) == SQLITE_IOERR) {
    const int system = database == nullptr ? 0 : sqlite3_system_errno(database);
    const std::string why = system == 0 ? sqlite3_errstr(result_code) : std::generic_category().message(system);
    return {ErrorCode::io, place,
            "cannot be read or written (" + why + "); check the disk and resume, nothing that was stored is lost"};
  }
  const std::string why = database == nullptr ? sqlite3_errstr(result_code) : sqlite3_errmsg(database);
  return {ErrorCode::bad_format, place, "is no usable eye file (SQLite: " + why + ")"};
}

}  // namespace compueye::calib
