#include "calib/eye_file/eye_file.hpp"

#include <utility>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/eye_identity.hpp"
#include "calib/eye_file/opening.hpp"
#include "hal/try.hpp"

namespace compueye::calib {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

EyeFile::EyeFile(std::string path, EyeFileMode mode, std::unique_ptr<Database> database)
    : path_(std::move(path)), mode_(mode), database_(std::move(database)) {}

EyeFile::EyeFile(EyeFile&&) noexcept = default;

EyeFile& EyeFile::operator=(EyeFile&& other) noexcept {
  static_cast<void>(close());
  path_ = std::move(other.path_);
  mode_ = other.mode_;
  has_log_ = other.has_log_;
  eye_ = std::move(other.eye_);
  database_ = std::move(other.database_);
  return *this;
}

EyeFile::~EyeFile() {
  static_cast<void>(close());
}

Result<EyeFile> EyeFile::create(const std::string& path, const EyeIdentity& eye) {
  TRY(check_eye(path, eye));
  const bool is_new = TRY(make_file(path));
  if (!is_new) {
    const auto usable = check_file(path);
    if (!usable && usable.error().code != ErrorCode::bad_format) return tl::unexpected(usable.error());
  }
  auto database = open_database(path, true);
  if (!database && database.error().code == ErrorCode::bad_format) return already_there(path);
  if (!database) return tl::unexpected(std::move(database.error()));
  EyeFile file(path, EyeFileMode::write, std::make_unique<Database>(std::move(*database)));
  {
    auto transaction = TRY(Transaction::begin(*file.database_, "BEGIN EXCLUSIVE"));
    if (!TRY(has_nothing(*file.database_))) return already_there(path);
    TRY(make_schema(*file.database_));
    TRY(store_eye(*file.database_, eye));
    TRY(transaction.commit());
  }
  TRY(file.begin_log());
  file.eye_ = TRY(load_eye(*file.database_));
  return file;
}

Result<EyeFile> EyeFile::open(const std::string& path, EyeFileMode mode) {
  const bool for_writing = mode == EyeFileMode::write;
  TRY(check_file(path));
  EyeFile file(path, mode, std::make_unique<Database>(TRY(open_database(path, for_writing))));
  TRY(check_schema(*file.database_));
  if (for_writing) TRY(file.begin_log());
  file.eye_ = TRY(load_eye(*file.database_));
  return file;
}

Result<void> EyeFile::close() {
  if (!database_) return {};
  const std::unique_ptr<Database> closing = std::move(database_);
  // What turned out to be no eye file is left as it was.
  if (!std::exchange(has_log_, false)) return {};
  return end_log(*closing);
}

Result<void> EyeFile::begin_log() {
  has_log_ = true;
  return start_log(*database_);
}

Result<void> EyeFile::check_open() const {
  if (database_) return {};
  return fail(ErrorCode::usage, path_, "has been closed; open it again");
}

Result<void> EyeFile::check_writable() const {
  TRY(check_open());
  if (mode_ == EyeFileMode::write) return {};
  return fail(ErrorCode::usage, path_, "was opened for reading only; open it for writing");
}

}  // namespace compueye::calib
