#include "calib/eye_file/estimate_records.hpp"

#include <string>
#include <string_view>

#include "calib/eye_file/blob_vector.hpp"
#include "calib/eye_file/estimate_parts.hpp"
#include "calib/eye_file/record_digest.hpp"
#include "calib/eye_file/response_blocks.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

std::vector<std::uint8_t> bytes_of(const std::vector<hal::ChannelStatus>& statuses) {
  std::vector<std::uint8_t> bytes;
  for (const hal::ChannelStatus status : statuses) bytes.push_back(static_cast<std::uint8_t>(status));
  return bytes;
}

std::int64_t digest_of(const EstimateRecord& record, std::span<const std::int64_t> block_hashes) {
  const Estimate& e = record.estimate;
  const ResponseShape& shape = record.shape;
  RecordDigest digest("estimate");
  for (const std::int64_t number :
       {record.id, e.parent.value_or(0), e.made_unix_s, static_cast<std::int64_t>(record.raw_hash),
        std::int64_t{shape.rows}, std::int64_t{shape.cols}, std::int64_t{shape.image_rows},
        std::int64_t{shape.image_cols}, std::int64_t{shape.dense ? 1 : 0}, shape.entries}) {
    digest.add(number);
  }
  for (const std::string* text : {&e.program, &e.method, &e.plan}) digest.add(*text);
  digest.add(e.distance_mm);
  digest.add(e.residual_pitch_px);
  digest.add(e.sessions);
  digest.add(bytes_of(e.status));
  digest.add(e.residual_counts);
  digest.add(e.residual);
  add_parts(digest, e);
  digest.add(std::as_bytes(block_hashes));
  return digest.value();
}

hal::Result<void> store_sessions(const Database& database, const EstimateRecord& record) {
  auto insert = TRY(database.prepare("INSERT INTO estimate_session VALUES (?, ?)"));
  for (const std::int64_t session : record.estimate.sessions) TRY(insert.with(record.id, session).run());
  return {};
}

hal::Result<void> load_sessions_of(const Database& database, EstimateRecord& record) {
  auto row = TRY(database.prepare("SELECT session FROM estimate_session WHERE estimate = ? ORDER BY session"));
  row.with(record.id);
  while (TRY(row.step())) record.estimate.sessions.push_back(row.integer(0));
  return {};
}

tl::unexpected<hal::Error> damaged(const Database& database, std::int64_t id) {
  return fail(ErrorCode::bad_format, database.path(),
              "is damaged: the hash of estimate " + std::to_string(id) +
                  " does not match it; take a copy of the file that is whole, or estimate again");
}

/// The row of the table "estimate" and the hash that it says it has.
hal::Result<std::int64_t> read_row(const Statement& row, const Database& database, EstimateRecord& record) {
  Estimate& e = record.estimate;
  if (!row.is_null(0)) e.parent = row.integer(0);
  e.made_unix_s = row.integer(1);
  e.program = row.text(2);
  e.method = row.text(3);
  e.plan = row.text(4);
  e.distance_mm = row.real(5);
  record.raw_hash = static_cast<std::uint64_t>(row.integer(6));
  record.shape = {static_cast<int>(row.integer(7)),
                  static_cast<int>(row.integer(8)),
                  static_cast<int>(row.integer(9)),
                  static_cast<int>(row.integer(10)),
                  row.integer(11) != 0,
                  row.integer(12)};
  for (const std::uint8_t number : vector_of<std::uint8_t>(row.blob(13))) {
    const auto status = hal::channel_status_of(number);
    if (!status) return damaged(database, record.id);
    e.status.push_back(*status);
  }
  e.residual_pitch_px = row.real(14);
  e.residual_counts = vector_of<std::int32_t>(row.blob(15));
  e.residual = vector_of<float>(row.blob(16));
  return row.integer(17);
}

}  // namespace

hal::Result<void> store_record(const Database& database, const EstimateRecord& record,
                               std::span<const std::int64_t> block_hashes) {
  const Estimate& e = record.estimate;
  const ResponseShape& shape = record.shape;
  auto insert =
      TRY(database.prepare("INSERT INTO estimate VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  const std::vector<std::uint8_t> status = bytes_of(e.status);
  TRY(insert
          .with(record.id, e.parent, e.made_unix_s, e.program, e.method, e.plan, e.distance_mm,
                static_cast<std::int64_t>(record.raw_hash), shape.rows, shape.cols, shape.image_rows, shape.image_cols,
                shape.dense ? 1 : 0, shape.entries, blob_of(status), e.residual_pitch_px, blob_of(e.residual_counts),
                blob_of(e.residual), digest_of(record, block_hashes))
          .run());
  TRY(store_sessions(database, record));
  return store_parts(database, record.id, e);
}

hal::Result<EstimateRecord> load_record(const Database& database, std::int64_t id) {
  auto row = TRY(database.prepare(
      "SELECT parent, made_unix_s, program, method, plan, distance_mm, raw_hash, ommatidia, pixels, "
      "image_rows, image_cols, dense, entries, status, residual_pitch_px, residual_counts, residual, hash "
      "FROM estimate WHERE id = ?"));
  if (!TRY(row.with(id).step())) {
    return fail(ErrorCode::not_found, database.path(), "has no estimate " + std::to_string(id));
  }
  EstimateRecord record;
  record.id = id;
  const std::int64_t hash = TRY(read_row(row, database, record));
  TRY(load_sessions_of(database, record));
  TRY(load_parts(database, id, record.estimate));
  if (hash != digest_of(record, TRY(load_block_hashes(database, id)))) return damaged(database, id);
  return record;
}

hal::Result<std::vector<std::int64_t>> record_ids(const Database& database) {
  auto row = TRY(database.prepare("SELECT id FROM estimate ORDER BY id"));
  std::vector<std::int64_t> ids;
  while (TRY(row.step())) ids.push_back(row.integer(0));
  return ids;
}

}  // namespace compueye::calib
