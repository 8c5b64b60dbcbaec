// EyeFile's sessions and captures.

#include <string>

#include "calib/eye_file/capture_records.hpp"
#include "calib/eye_file/database.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "calib/eye_file/record_digest.hpp"
#include "calib/eye_file/session_records.hpp"
#include "hal/try.hpp"

namespace compueye::calib {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

namespace {

Result<StoredSession> session_under_way(const Database& database, std::int64_t id) {
  auto session = TRY(load_session(database, id));
  if (!session.end) return session;
  return fail(ErrorCode::usage, database.path(),
              "has session " + std::to_string(id) + " as ended, with " + std::to_string(session.end->captures) +
                  " captures; begin another one");
}

}  // namespace

Result<std::int64_t> EyeFile::begin_session(const Session& session) {
  TRY(check_writable());
  auto transaction = TRY(Transaction::begin(*database_, "BEGIN IMMEDIATE"));
  const std::int64_t id = TRY(store_session(*database_, session));
  TRY(transaction.commit());
  return id;
}

Result<std::int64_t> EyeFile::append_capture(std::int64_t session, const Capture& capture) {
  TRY(check_writable());
  TRY(check_capture(path_, capture, eye_.geometry.ommatidia()));
  auto transaction = TRY(Transaction::begin(*database_, "BEGIN IMMEDIATE"));
  TRY(session_under_way(*database_, session));
  const std::int64_t position = TRY(count_captures(*database_, session));
  TRY(store_capture(*database_, session, position, capture));
  TRY(transaction.commit());
  return position;
}

Result<void> EyeFile::end_session(std::int64_t session) {
  TRY(check_writable());
  auto transaction = TRY(Transaction::begin(*database_, "BEGIN IMMEDIATE"));
  const StoredSession stored = TRY(session_under_way(*database_, session));
  RecordDigest raw(raw_data);
  TRY(add_capture_hashes(*database_, session, raw));
  const SessionEnd end{TRY(count_captures(*database_, session)), static_cast<std::uint64_t>(raw.value())};
  TRY(store_session_end(*database_, stored, end));
  return transaction.commit();
}

Result<std::vector<StoredSession>> EyeFile::sessions() const {
  TRY(check_open());
  return load_sessions(*database_);
}

Result<std::int64_t> EyeFile::capture_count(std::int64_t session) const {
  TRY(check_open());
  TRY(load_session(*database_, session));
  return count_captures(*database_, session);
}

Result<CaptureReader> EyeFile::captures(std::int64_t session) const {
  TRY(check_open());
  return CaptureReader(*this, TRY(load_session(*database_, session)));
}

Result<std::uint64_t> EyeFile::raw_hash(std::span<const std::int64_t> sessions) const {
  TRY(check_open());
  RecordDigest raw(raw_data);
  for (const std::int64_t session : sessions) {
    TRY(load_session(*database_, session));
    TRY(add_capture_hashes(*database_, session, raw));
  }
  return static_cast<std::uint64_t>(raw.value());
}

Result<std::optional<Capture>> CaptureReader::next() {
  TRY(file_->check_open());
  auto capture = TRY(load_capture(*file_->database_, session_.id, position_, raw_));
  if (capture) {
    ++position_;
  } else {
    TRY(check_end());
  }
  return capture;
}

Result<void> CaptureReader::check_end() const {
  const std::int64_t stored = TRY(count_captures(*file_->database_, session_.id));
  const auto& end = session_.end;
  if (stored <= position_ &&
      (!end || (end->captures == position_ && end->raw_hash == static_cast<std::uint64_t>(raw_.value()))))
    return {};
  return fail(ErrorCode::bad_format, file_->path(),
              "is damaged: session " + std::to_string(session_.id) + " lacks captures from number " +
                  std::to_string(position_) +
                  " on, or has others than it ended with; take a copy of the file that is whole");
}

}  // namespace compueye::calib
