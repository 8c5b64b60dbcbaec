#include "calib/eye_file/capture_records.hpp"

#include <cmath>
#include <string>

#include "calib/eye_file/blob_vector.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

enum : int { overrun = 1, saturated = 2, dark = 4, time_ok = 8 };

int number_of(const hal::BlockFlags& flags) noexcept {
  return (flags.overrun ? overrun : 0) + (flags.saturated ? saturated : 0) + (flags.dark ? dark : 0) +
         (flags.time_ok ? time_ok : 0);
}

hal::BlockFlags flags_of(std::int64_t number) noexcept {
  return {(number & overrun) != 0, (number & saturated) != 0, (number & dark) != 0, (number & time_ok) != 0};
}

void add(RecordDigest& digest, const std::optional<double>& number) {
  digest.add(std::int64_t{number ? 1 : 0});
  if (number) digest.add(*number);
}

std::int64_t digest_of(std::int64_t session, std::int64_t position, const Capture& c) {
  RecordDigest digest("capture");
  digest.add(c.stage);
  digest.add(c.family);
  for (const std::int64_t number :
       {session, position, static_cast<std::int64_t>(c.seed), c.pattern, std::int64_t{c.repeat}, std::int64_t{c.frames},
        c.device_ns, std::int64_t{number_of(c.flags)}}) {
    digest.add(number);
  }
  add(digest, c.exposure_s);
  add(digest, c.temperature_c);
  digest.add(c.valid);
  digest.add(c.codes);
  return digest.value();
}

std::optional<double> optional_real(const Statement& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.real(column));
}

}  // namespace

hal::Result<void> check_capture(const std::string& path, const Capture& c, int ommatidia) {
  const auto channels = static_cast<std::size_t>(ommatidia);
  if (c.codes.size() != channels || (!c.valid.empty() && c.valid.size() != channels)) {
    return fail(ErrorCode::mismatch, path,
                "was given a capture of " + std::to_string(c.codes.size()) + " codes and the validity of " +
                    std::to_string(c.valid.size()) + ", expected " + std::to_string(ommatidia) + " of each");
  }
  if (c.frames < 1 || c.repeat < 0) {
    return fail(ErrorCode::out_of_range, path,
                "was given a capture of " + std::to_string(c.frames) + " frames and repeat " +
                    std::to_string(c.repeat) + ", expected at least 1 and 0");
  }
  for (const auto& number : {c.exposure_s, c.temperature_c}) {
    if (number && !std::isfinite(*number)) {
      return fail(ErrorCode::out_of_range, path, "was given a capture whose exposure or temperature is not finite");
    }
  }
  return {};
}

hal::Result<void> store_capture(const Database& database, std::int64_t session, std::int64_t position,
                                const Capture& c) {
  auto insert = TRY(database.prepare(
      "INSERT INTO capture(session, position, stage, family, seed, pattern, repeat, frames, device_ns, "
      "exposure_s, temperature_c, flags, valid, codes, hash) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  return insert
      .with(session, position, c.stage, c.family, static_cast<std::int64_t>(c.seed), c.pattern, c.repeat, c.frames,
            c.device_ns, c.exposure_s, c.temperature_c, number_of(c.flags), blob_of(c.valid), blob_of(c.codes),
            digest_of(session, position, c))
      .run();
}

hal::Result<std::int64_t> count_captures(const Database& database, std::int64_t session) {
  auto row = TRY(database.prepare("SELECT coalesce(max(position) + 1, 0) FROM capture WHERE session = ?"));
  return TRY(row.with(session).step()) ? row.integer(0) : 0;
}

hal::Result<std::optional<Capture>> load_capture(const Database& database, std::int64_t session, std::int64_t position,
                                                 RecordDigest& raw) {
  auto row = TRY(database.prepare(
      "SELECT stage, family, seed, pattern, repeat, frames, device_ns, exposure_s, temperature_c, flags, "
      "valid, codes, hash FROM capture WHERE session = ? AND position = ?"));
  if (!TRY(row.with(session, position).step())) return std::nullopt;
  Capture c;
  c.stage = row.text(0);
  c.family = row.text(1);
  c.seed = static_cast<std::uint64_t>(row.integer(2));
  c.pattern = row.integer(3);
  c.repeat = static_cast<int>(row.integer(4));
  c.frames = static_cast<int>(row.integer(5));
  c.device_ns = row.integer(6);
  c.exposure_s = optional_real(row, 7);
  c.temperature_c = optional_real(row, 8);
  c.flags = flags_of(row.integer(9));
  c.valid = vector_of<std::uint8_t>(row.blob(10));
  c.codes = vector_of<std::int32_t>(row.blob(11));
  const std::int64_t hash = row.integer(12);
  if (hash != digest_of(session, position, c)) {
    return fail(ErrorCode::bad_format, database.path(),
                "is damaged: the hash of capture " + std::to_string(position) + " of session " +
                    std::to_string(session) +
                    " does not match it; take a copy of the file that is whole, or the session again");
  }
  raw.add(hash);
  return c;
}

hal::Result<void> add_capture_hashes(const Database& database, std::int64_t session, RecordDigest& raw) {
  auto row = TRY(database.prepare("SELECT hash FROM capture WHERE session = ? ORDER BY position"));
  row.with(session);
  while (TRY(row.step())) raw.add(row.integer(0));
  return {};
}

}  // namespace compueye::calib
