#include "calib/eye_file/session_records.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "calib/eye_file/record_digest.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

std::int64_t digest_of(const StoredSession& stored) {
  const Session& s = stored.begun;
  RecordDigest digest("session");
  digest.add(stored.id);
  for (const std::string* text :
       {&s.serial, &s.firmware, &s.configuration, &s.pattern_generator, &s.plan, &s.program}) {
    digest.add(*text);
  }
  digest.add(std::int64_t{s.config_id});
  digest.add(static_cast<std::int64_t>(s.seed));
  digest.add(std::int64_t{s.bits});
  digest.add(s.distance_mm);
  digest.add(s.started_unix_s);
  if (stored.end) {
    digest.add(stored.end->captures);
    digest.add(static_cast<std::int64_t>(stored.end->raw_hash));
  }
  return digest.value();
}

constexpr const char* select_sessions =
    "SELECT id, serial, firmware, config_id, configuration, pattern_generator, seed, plan, program, bits, distance_mm, "
    "started_unix_s, captures, raw_hash, hash FROM session ";

hal::Result<StoredSession> session_of(const Statement& row, const std::string& path) {
  StoredSession stored;
  Session& s = stored.begun;
  stored.id = row.integer(0);
  s.serial = row.text(1);
  s.firmware = row.text(2);
  s.config_id = static_cast<std::uint32_t>(row.integer(3));
  s.configuration = row.text(4);
  s.pattern_generator = row.text(5);
  s.seed = static_cast<std::uint64_t>(row.integer(6));
  s.plan = row.text(7);
  s.program = row.text(8);
  s.bits = static_cast<int>(row.integer(9));
  s.distance_mm = row.real(10);
  s.started_unix_s = row.integer(11);
  if (!row.is_null(12)) stored.end = SessionEnd{row.integer(12), static_cast<std::uint64_t>(row.integer(13))};
  if (row.integer(14) == digest_of(stored)) return stored;
  return fail(ErrorCode::bad_format, path,
              "is damaged: the hash of session " + std::to_string(stored.id) +
                  " does not match it; take a copy of the file that is whole");
}

}  // namespace

hal::Result<std::int64_t> store_session(const Database& database, const Session& s) {
  if (s.bits < 1 || s.bits > 24) {
    return fail(ErrorCode::out_of_range, database.path(),
                "was given a session with codes of " + std::to_string(s.bits) + " bits, expected 1 to 24");
  }
  if (!std::isfinite(s.distance_mm) || s.distance_mm <= 0.0) {
    return fail(ErrorCode::out_of_range, database.path(),
                "was given a session at a distance of " + std::to_string(s.distance_mm) + " mm, expected more than 0");
  }
  StoredSession stored{TRY(database.integer_of("SELECT max(id) FROM session")) + 1, s, std::nullopt};
  auto insert = TRY(database.prepare("INSERT INTO session VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, NULL, NULL, ?)"));
  TRY(insert
          .with(stored.id, s.serial, s.firmware, std::int64_t{s.config_id}, s.configuration, s.pattern_generator,
                static_cast<std::int64_t>(s.seed), s.plan, s.program, s.bits, s.distance_mm, s.started_unix_s,
                digest_of(stored))
          .run());
  return stored.id;
}

hal::Result<StoredSession> load_session(const Database& database, std::int64_t id) {
  auto row = TRY(database.prepare(std::string(select_sessions) + "WHERE id = ?"));
  if (TRY(row.with(id).step())) return session_of(row, database.path());
  return fail(ErrorCode::not_found, database.path(), "has no session " + std::to_string(id));
}

hal::Result<std::vector<StoredSession>> load_sessions(const Database& database) {
  auto row = TRY(database.prepare(std::string(select_sessions) + "ORDER BY id"));
  std::vector<StoredSession> sessions;
  while (TRY(row.step())) sessions.push_back(TRY(session_of(row, database.path())));
  return sessions;
}

hal::Result<void> store_session_end(const Database& database, StoredSession session, SessionEnd end) {
  session.end = end;
  auto update = TRY(database.prepare("UPDATE session SET captures = ?, raw_hash = ?, hash = ? WHERE id = ?"));
  return update.with(end.captures, static_cast<std::int64_t>(end.raw_hash), digest_of(session), session.id).run();
}

}  // namespace compueye::calib
