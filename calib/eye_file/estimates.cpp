// EyeFile's estimates and their responses.

#include <string>

#include "calib/eye_file/database.hpp"
#include "calib/eye_file/estimate_check.hpp"
#include "calib/eye_file/estimate_records.hpp"
#include "calib/eye_file/eye_file.hpp"
#include "calib/eye_file/response_blocks.hpp"
#include "hal/try.hpp"

namespace compueye::calib {

using hal::Result;

Result<std::int64_t> EyeFile::store_estimate(const Estimate& estimate, const recon::Response& response,
                                             std::span<const float> sigma) {
  TRY(check_writable());
  const ResponseShape shape{response.rows(),       response.cols(),     response.image_rows(),
                            response.image_cols(), response.is_dense(), response.stored_entries()};
  TRY(check_estimate(path_, estimate, eye_.geometry.ommatidia()));
  TRY(check_shape(path_, shape, sigma.size(), eye_.geometry.ommatidia()));

  auto transaction = TRY(Transaction::begin(*database_, "BEGIN IMMEDIATE"));
  if (estimate.parent) TRY(load_record(*database_, *estimate.parent));
  const std::int64_t id = TRY(database_->integer_of("SELECT max(id) FROM estimate")) + 1;
  const EstimateRecord record{id, TRY(raw_hash(estimate.sessions)), shape, estimate};
  // Its hash is over theirs, and they refer to it.
  TRY(database_->execute("PRAGMA defer_foreign_keys = ON"));
  TRY(store_record(*database_, record, TRY(store_blocks(*database_, id, response, sigma))));
  TRY(transaction.commit());
  return id;
}

Result<std::vector<StoredEstimate>> EyeFile::estimates() const {
  TRY(check_open());
  const auto transaction = TRY(Transaction::begin(*database_));
  std::vector<StoredEstimate> list;
  for (const std::int64_t id : TRY(record_ids(*database_))) {
    const EstimateRecord record = TRY(load_record(*database_, id));
    list.push_back(
        {id, record.estimate.made_unix_s, record.estimate.distance_mm, record.estimate.method, record.raw_hash});
  }
  return list;
}

Result<Estimate> EyeFile::load_estimate(std::int64_t estimate) const {
  TRY(check_open());
  const auto transaction = TRY(Transaction::begin(*database_));
  EstimateRecord record = TRY(load_record(*database_, estimate));
  TRY(check_estimate(path_, record.estimate, eye_.geometry.ommatidia()));
  return std::move(record.estimate);
}

Result<MeasuredResponse> EyeFile::load_response(std::int64_t estimate) const {
  TRY(check_open());
  const auto transaction = TRY(Transaction::begin(*database_));
  const EstimateRecord record = TRY(load_record(*database_, estimate));
  TRY(check_shape(path_, record.shape, 0, eye_.geometry.ommatidia()));
  return load_blocks(*database_, estimate, record.shape);
}

}  // namespace compueye::calib
