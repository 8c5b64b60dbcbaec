#include "calib/eye_file/database.hpp"

#include <sqlite3.h>

#include "hal/try.hpp"

namespace compueye::calib {
namespace {

/// As SQLite takes it: not as one of its names with a meaning ("", ":memory:", "file:...").
std::string as_file_name(const std::string& path) {
  return path.starts_with('/') ? path : "./" + path;
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const noexcept {
  sqlite3_finalize(statement);
}

void Statement::note(int result_code) noexcept {
  if (bind_failure_ == SQLITE_OK) bind_failure_ = result_code;
}

void Statement::bind(int place, std::int64_t value) noexcept {
  note(sqlite3_bind_int64(statement_.get(), place, value));
}

void Statement::bind(int place, double value) noexcept {
  note(sqlite3_bind_double(statement_.get(), place, value));
}

void Statement::bind(int place, const std::optional<double>& value) noexcept {
  note(value ? sqlite3_bind_double(statement_.get(), place, *value) : sqlite3_bind_null(statement_.get(), place));
}

void Statement::bind(int place, const std::optional<std::int64_t>& value) noexcept {
  note(value ? sqlite3_bind_int64(statement_.get(), place, *value) : sqlite3_bind_null(statement_.get(), place));
}

void Statement::bind(int place, std::string_view value) noexcept {
  const char* text = value.data() == nullptr ? "" : value.data();
  note(sqlite3_bind_text64(statement_.get(), place, text, value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}

void Statement::bind(int place, std::span<const std::byte> value) noexcept {
  if (value.empty()) {
    note(sqlite3_bind_zeroblob(statement_.get(), place, 0));  // a blob at no address would be NULL
  } else {
    note(sqlite3_bind_blob64(statement_.get(), place, value.data(), value.size(), SQLITE_STATIC));
  }
}

hal::Result<bool> Statement::step() {
  const int code = bind_failure_ != SQLITE_OK ? bind_failure_ : sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  auto error = database_error(*path_, code, sqlite3_db_handle(statement_.get()));
  reset();
  return tl::unexpected(std::move(error));
}

hal::Result<void> Statement::run() {
  while (TRY(step())) {
  }
  reset();
  return {};
}

void Statement::reset() noexcept {
  sqlite3_reset(statement_.get());
  bind_failure_ = SQLITE_OK;
}

bool Statement::is_null(int column) const noexcept {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const noexcept {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::real(int column) const noexcept {
  return sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const auto* text = sqlite3_column_text(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text), size);
}

std::span<const std::byte> Statement::blob(int column) const noexcept {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  if (bytes == nullptr) return {};
  return {static_cast<const std::byte*>(bytes), size};
}

void Database::Close::operator()(sqlite3* database) const noexcept {
  sqlite3_close_v2(database);
}

hal::Result<Database> Database::open(const std::string& path, bool for_writing) {
  Database made;
  made.path_ = std::make_unique<const std::string>(path);
  sqlite3* opened = nullptr;
  const int mode = path.empty()  ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY
                   : for_writing ? SQLITE_OPEN_READWRITE
                                 : SQLITE_OPEN_READONLY;
  const int code = sqlite3_open_v2(path.empty() ? ":memory:" : as_file_name(path).c_str(), &opened,
                                   mode | SQLITE_OPEN_EXRESCODE, nullptr);
  made.database_.reset(opened);
  if (code != SQLITE_OK) return tl::unexpected(database_error(path, code, opened));
  // Whoever made the file may have put into it what runs when it is read.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  TRY(made.execute("PRAGMA cell_size_check = ON"));
  return made;
}

bool Database::is_read_only() const noexcept {
  return sqlite3_db_readonly(database_.get(), "main") == 1;
}

hal::Result<Statement> Database::prepare(std::string_view sql) const {
  sqlite3_stmt* prepared = nullptr;
  const int code = sqlite3_prepare_v2(database_.get(), sql.data(), static_cast<int>(sql.size()), &prepared, nullptr);
  if (code != SQLITE_OK) return tl::unexpected(database_error(*path_, code, database_.get()));
  return Statement(prepared, *path_);
}

hal::Result<void> Database::execute(std::string_view sql) const {
  const int code = sqlite3_exec(database_.get(), sql.data(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return tl::unexpected(database_error(*path_, code, database_.get()));
  return {};
}

// Both go on to the end, where a statement commits what it has changed.
hal::Result<std::int64_t> Database::integer_of(std::string_view sql) const {
  auto statement = TRY(prepare(sql));
  const std::int64_t value = TRY(statement.step()) ? statement.integer(0) : 0;
  TRY(statement.run());
  return value;
}

hal::Result<std::string> Database::text_of(std::string_view sql) const {
  auto statement = TRY(prepare(sql));
  std::string value = TRY(statement.step()) ? statement.text(0) : std::string();
  TRY(statement.run());
  return value;
}

hal::Result<Transaction> Transaction::begin(const Database& database, std::string_view begin) {
  TRY(database.execute(begin));
  return Transaction(database);
}

Transaction::~Transaction() {
  // An error may have rolled it back already.
  if (database_ != nullptr && sqlite3_get_autocommit(database_->database_.get()) == 0) {
    static_cast<void>(database_->execute("ROLLBACK"));
  }
}

hal::Result<void> Transaction::commit() {
  TRY(database_->execute("COMMIT"));
  database_ = nullptr;
  return {};
}

}  // namespace compueye::calib
