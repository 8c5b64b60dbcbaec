#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "hal/result.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace compueye::calib {

/// What a result code of SQLite means for the file at `path`, in a sentence to act on. `database` may be null.
[[nodiscard]] hal::Error database_error(const std::string& path, int result_code, sqlite3* database);

/// One prepared statement of a Database, which outlives it. Results of step() are read by column, from 0.
class Statement {
 public:
  /// All parameters, in order; starts the statement anew. Blobs are not copied: they outlive the last step().
  template <class... Values>
  Statement& with(const Values&... values) {
    reset();
    int place = 0;
    (bind(++place, values), ...);
    return *this;
  }

  /// Whether there is a (next) row.
  [[nodiscard]] hal::Result<bool> step();
  /// To the end, whatever rows are left.
  [[nodiscard]] hal::Result<void> run();
  /// Lets go of the row, and with it of the lock for reading.
  void reset() noexcept;

  [[nodiscard]] bool is_null(int column) const noexcept;
  [[nodiscard]] std::int64_t integer(int column) const noexcept;
  [[nodiscard]] double real(int column) const noexcept;
  [[nodiscard]] std::string text(int column) const;
  /// Valid until the next step() or reset().
  [[nodiscard]] std::span<const std::byte> blob(int column) const noexcept;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const noexcept;
  };
  Statement(sqlite3_stmt* statement, const std::string& path) : statement_(statement), path_(&path) {}

  void bind(int place, std::int64_t value) noexcept;
  void bind(int place, int value) noexcept { bind(place, std::int64_t{value}); }
  void bind(int place, double value) noexcept;
  void bind(int place, const std::optional<double>& value) noexcept;
  void bind(int place, const std::optional<std::int64_t>& value) noexcept;
  void bind(int place, const std::string& value) noexcept { bind(place, std::string_view(value)); }
  void bind(int place, std::string_view value) noexcept;
  void bind(int place, std::span<const std::byte> value) noexcept;
  void note(int result_code) noexcept;

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  const std::string* path_;
  int bind_failure_ = 0;
};

/// An open SQLite file: the only door to the library. A test that wants another file system below registers it as
/// SQLite's default one.
class Database {
 public:
  /// Neither makes a file nor reads one: that happens with the first statement. `path` empty: in memory.
  [[nodiscard]] static hal::Result<Database> open(const std::string& path, bool for_writing);
  Database(Database&&) noexcept = default;
  Database& operator=(Database&&) noexcept = default;
  ~Database() = default;

  [[nodiscard]] const std::string& path() const noexcept { return *path_; }
  [[nodiscard]] bool is_read_only() const noexcept;

  [[nodiscard]] hal::Result<Statement> prepare(std::string_view sql) const;
  /// Statements without parameters, one after the other; `sql` ends with a zero.
  [[nodiscard]] hal::Result<void> execute(std::string_view sql) const;
  /// The first column of the first row.
  [[nodiscard]] hal::Result<std::int64_t> integer_of(std::string_view sql) const;
  [[nodiscard]] hal::Result<std::string> text_of(std::string_view sql) const;

 private:
  friend class Transaction;
  struct Close {
    void operator()(sqlite3* database) const noexcept;
  };
  Database() = default;

  std::unique_ptr<const std::string> path_;  // statements refer to it
  std::unique_ptr<sqlite3, Close> database_;
};

/// All of it or nothing: rolled back unless committed. Inside it a reader sees one state of the file.
class Transaction {
 public:
  [[nodiscard]] static hal::Result<Transaction> begin(const Database& database, std::string_view begin = "BEGIN");
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  [[nodiscard]] hal::Result<void> commit();

 private:
  explicit Transaction(const Database& database) noexcept : database_(&database) {}
  const Database* database_;
};

}  // namespace compueye::calib
