#include "calib/eye_file/opening.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <system_error>
#include <vector>

#include "calib/eye_file/schema_text.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

tl::unexpected<hal::Error> refused(const std::string& path, std::string_view what, int error_number) {
  const ErrorCode code = error_number == ENOENT || error_number == ENOTDIR  ? ErrorCode::not_found
                         : error_number == ENOSPC || error_number == EDQUOT ? ErrorCode::no_space
                                                                            : ErrorCode::io;
  return fail(
      code, path,
      std::string(what) + ": " + std::generic_category().message(error_number) + "; check the path and who owns it");
}

tl::unexpected<hal::Error> empty(const std::string& path) {
  return fail(ErrorCode::bad_format, path, "is empty, so it is no eye file; remove it, or make one of it");
}

void flush_folder_of(const std::string& path) {
  const auto slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);  // some file systems cannot, and then need not
  ::close(fd);
}

struct Item {
  std::string type, name, table, sql;
  bool operator==(const Item&) const = default;
};

/// Tables, indices, and what should not be there: views and triggers.
hal::Result<std::vector<Item>> items_of(const Database& database) {
  auto rows =
      TRY(database.prepare("SELECT type, name, tbl_name, sql FROM sqlite_schema WHERE name NOT LIKE 'sqlite\\_%' "
                           "ESCAPE '\\' ORDER BY type, name"));
  std::vector<Item> items;
  while (TRY(rows.step())) items.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3)});
  return items;
}

hal::Result<void> set_journal(const Database& database, const std::string& mode) {
  if (TRY(database.text_of("PRAGMA journal_mode = " + mode)) == mode) return {};
  return fail(ErrorCode::io, database.path(),
              "cannot be given SQLite's journal mode '" + mode + "'; move it to a local disk");
}

}  // namespace

hal::Result<bool> make_file(const std::string& path) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0 && errno == EEXIST) return false;
  if (fd < 0) return refused(path, "cannot be made", errno);
  ::close(fd);
  flush_folder_of(path);
  return true;
}

tl::unexpected<hal::Error> already_there(const std::string& path) {
  return fail(ErrorCode::io, path, "is there already and is never overwritten; choose another name or remove it");
}

hal::Result<bool> has_nothing(const Database& database) {
  return TRY(database.integer_of("SELECT count(*) FROM sqlite_schema")) == 0 &&
         TRY(database.integer_of("PRAGMA application_id")) == 0;
}

hal::Result<void> check_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return refused(path, "cannot be opened", errno);
  if (S_ISDIR(status.st_mode)) return fail(ErrorCode::io, path, "is a folder; name an eye file");
  if (!S_ISREG(status.st_mode)) return fail(ErrorCode::io, path, "is a pipe or a device; name an eye file");
  if (status.st_size > 0) return {};
  return empty(path);
}

hal::Result<Database> open_database(const std::string& path, bool for_writing) {
  auto database = TRY(Database::open(path, for_writing));
  if (!for_writing) {
    TRY(database.execute("PRAGMA query_only = ON"));
    return database;
  }
  if (database.is_read_only()) {
    return fail(
        ErrorCode::io, path,
        "cannot be written: the file, its folder or its file system is read-only; check who owns it, or copy it "
        "to where it may be written");
  }
  // Kept after the first transaction until the file is closed.
  TRY(database.execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON"));
  auto lock = TRY(Transaction::begin(database, "BEGIN EXCLUSIVE"));
  TRY(lock.commit());
  return database;
}

hal::Result<void> make_schema(const Database& database) {
  return database.execute(schema_text());
}

hal::Result<void> check_schema(const Database& database) {
  const Database ours = TRY(Database::open({}, true));
  TRY(make_schema(ours));
  const std::string& path = database.path();
  if (TRY(has_nothing(database))) return empty(path);
  const auto application = TRY(database.integer_of("PRAGMA application_id"));
  if (application != TRY(ours.integer_of("PRAGMA application_id"))) {
    return fail(ErrorCode::bad_format, path,
                "is not an eye file: it is the SQLite database of another program (application id " +
                    std::to_string(application) + ")");
  }
  const auto version = TRY(database.integer_of("PRAGMA user_version"));
  const auto known = TRY(ours.integer_of("PRAGMA user_version"));
  if (version > known) {
    return fail(ErrorCode::unsupported, path,
                "was written by a newer program: its version is " + std::to_string(version) +
                    ", this program knows up to " + std::to_string(known) + "; update it");
  }
  const bool same = TRY(items_of(database)) == TRY(items_of(ours));
  if (version != known || !same) {
    return fail(ErrorCode::bad_format, path,
                "is damaged: its tables are not those of version " + std::to_string(known) +
                    " of eye files; take a copy of it that is whole");
  }
  return {};
}

hal::Result<void> start_log(const Database& database) {
  return set_journal(database, "wal");
}

hal::Result<void> end_log(const Database& database) {
  TRY(set_journal(database, "delete"));
  // A reader that came after a writer was killed leaves its index of the log behind; nobody else can be using it now.
  ::unlink((database.path() + "-shm").c_str());
  return {};
}

}  // namespace compueye::calib
