#include "calib/eye_file/response_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "calib/eye_file/blob_vector.hpp"
#include "calib/eye_file/record_digest.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;

constexpr std::size_t entries_a_block = std::size_t{1} << 18;
constexpr double largest_entry = std::numeric_limits<float>::max();

/// A block as it lies in the file.
struct BlockBytes {
  std::int64_t first_row = 0;
  std::span<const std::byte> counts, columns, entries, sigmas;

  [[nodiscard]] std::int64_t digest() const noexcept {
    RecordDigest digest("response block");
    digest.add(first_row);
    for (const auto& part : {counts, columns, entries, sigmas}) digest.add(part);
    return digest.value();
  }
};

class BlockWriter {
 public:
  BlockWriter(Statement& insert, std::int64_t estimate) : insert_(insert), estimate_(estimate) {}

  void add_row(const recon::Response& response, int row, std::span<const float> sigmas) {
    const std::size_t before = entries_.size();
    response.for_each_in_row(row, [&](std::int32_t col, double value) {
      if (!response.is_dense()) columns_.push_back(col);
      entries_.push_back(static_cast<float>(value));
    });
    sigmas_.insert(sigmas_.end(), sigmas.begin(), sigmas.end());
    counts_.push_back(static_cast<std::int32_t>(entries_.size() - before));
  }

  [[nodiscard]] bool is_full() const noexcept { return entries_.size() >= entries_a_block; }

  hal::Result<void> flush() {
    if (counts_.empty()) return {};
    const BlockBytes block{first_row_, blob_of(counts_), blob_of(columns_), blob_of(entries_), blob_of(sigmas_)};
    const std::int64_t hash = block.digest();
    TRY(insert_.with(estimate_, first_row_, block.counts, block.columns, block.entries, block.sigmas, hash).run());
    hashes_.push_back(hash);
    first_row_ += static_cast<std::int64_t>(counts_.size());
    counts_.clear();
    columns_.clear();
    entries_.clear();
    sigmas_.clear();
    return {};
  }

  [[nodiscard]] std::vector<std::int64_t> hashes() && { return std::move(hashes_); }

 private:
  Statement& insert_;
  std::int64_t estimate_;
  std::int64_t first_row_ = 0;
  std::vector<std::int32_t> counts_, columns_;
  std::vector<float> entries_, sigmas_;
  std::vector<std::int64_t> hashes_;
};

/// Rows as they come in, block after block.
class RowCollector {
 public:
  explicit RowCollector(const ResponseShape& shape) : shape_(shape) {
    const auto entries = static_cast<std::size_t>(shape.entries);
    values_.reserve(entries);
    if (!shape.dense) columns_.reserve(entries);
    start_.push_back(0);
  }

  [[nodiscard]] std::int64_t rows() const noexcept { return static_cast<std::int64_t>(start_.size()) - 1; }

  /// Whether the block goes on where the last one ended, and its parts fit each other.
  [[nodiscard]] bool add(const BlockBytes& block) {
    if (block.first_row != rows()) return false;
    const std::size_t entries = block.entries.size() / sizeof(float);
    const std::size_t columns = shape_.dense ? 0 : entries, sigmas = block.sigmas.empty() ? 0 : entries;
    std::int64_t next = start_.back();
    for (const std::int32_t count : vector_of<std::int32_t>(block.counts)) {
      if (count < 0) return false;
      start_.push_back(next += count);
    }
    if (next > shape_.entries || next != static_cast<std::int64_t>(values_.size() + entries) ||
        block.entries.size() != entries * sizeof(float) || block.columns.size() != columns * sizeof(std::int32_t) ||
        block.sigmas.size() != sigmas * sizeof(float)) {
      return false;
    }
    append<float>(values_, block.entries);
    append<std::int32_t>(columns_, block.columns);
    append<float>(sigma_, block.sigmas);
    return true;
  }

  hal::Result<MeasuredResponse> response() && {
    const bool whole = rows() == shape_.rows && static_cast<std::int64_t>(values_.size()) == shape_.entries &&
                       (sigma_.empty() || sigma_.size() == values_.size());
    if (!whole) return fail(ErrorCode::bad_format, "response", "has not all of its rows");
    auto response = shape_.dense ? TRY(recon::Response::from_dense(shape_.rows, shape_.cols, std::move(values_)))
                                 : TRY(recon::Response::from_csr(shape_.rows, shape_.cols, std::move(start_),
                                                                 std::move(columns_), std::move(values_)));
    return MeasuredResponse{TRY(std::move(response).with_image(shape_.image_rows, shape_.image_cols)),
                            std::move(sigma_)};
  }

 private:
  template <class Stored, class Kept>
  static void append(std::vector<Kept>& to, std::span<const std::byte> bytes) {
    const std::size_t before = to.size(), count = bytes.size() / sizeof(Stored);
    to.resize(before + count);
    for (std::size_t n = 0; n < count; ++n) {
      Stored value;
      std::memcpy(&value, bytes.data() + n * sizeof(Stored), sizeof(Stored));
      to[before + n] = value;
    }
  }

  const ResponseShape& shape_;
  std::vector<std::int64_t> start_;
  std::vector<std::int32_t> columns_;
  std::vector<double> values_;
  std::vector<float> sigma_;
};

hal::Result<void> check_numbers(const std::string& path, std::span<const double> entries,
                                std::span<const float> sigma) {
  if (std::any_of(entries.begin(), entries.end(), [](double v) { return std::abs(v) > largest_entry; })) {
    return fail(ErrorCode::out_of_range, path, "was given a response with an entry that float32 cannot hold");
  }
  if (!std::all_of(sigma.begin(), sigma.end(), [](float s) { return std::isfinite(s) && s >= 0.0F; })) {
    return fail(ErrorCode::out_of_range, path, "was given a sigma that is negative or not finite");
  }
  return {};
}

}  // namespace

hal::Result<std::vector<std::int64_t>> store_blocks(const Database& database, std::int64_t estimate,
                                                    const recon::Response& response, std::span<const float> sigma) {
  TRY(check_numbers(database.path(), response.values(), sigma));
  auto insert = TRY(database.prepare("INSERT INTO response_block VALUES (?, ?, ?, ?, ?, ?, ?)"));
  BlockWriter writer(insert, estimate);
  const auto starts = response.row_start();
  for (int m = 0; m < response.rows(); ++m) {
    const auto row = static_cast<std::size_t>(m), width = static_cast<std::size_t>(response.cols());
    const std::size_t begin = response.is_dense() ? row * width : static_cast<std::size_t>(starts[row]);
    const std::size_t end = response.is_dense() ? begin + width : static_cast<std::size_t>(starts[row + 1]);
    writer.add_row(response, m, sigma.empty() ? sigma : sigma.subspan(begin, end - begin));
    if (writer.is_full()) TRY(writer.flush());
  }
  TRY(writer.flush());
  return std::move(writer).hashes();
}

hal::Result<std::vector<std::int64_t>> load_block_hashes(const Database& database, std::int64_t estimate) {
  auto row = TRY(database.prepare("SELECT hash FROM response_block WHERE estimate = ? ORDER BY first_row"));
  row.with(estimate);
  std::vector<std::int64_t> hashes;
  while (TRY(row.step())) hashes.push_back(row.integer(0));
  return hashes;
}

hal::Result<MeasuredResponse> load_blocks(const Database& database, std::int64_t estimate, const ResponseShape& shape) {
  const auto damaged = [&](std::int64_t row) {
    return fail(ErrorCode::bad_format, database.path(),
                "is damaged: the rows of estimate " + std::to_string(estimate) + " from " + std::to_string(row) +
                    " on do not match their hash; take a copy of the file that is whole, or estimate again");
  };
  // Before memory is taken for as many.
  auto size = TRY(database.prepare("SELECT sum(length(entries)) FROM response_block WHERE estimate = ?"));
  const std::int64_t bytes = TRY(size.with(estimate).step()) ? size.integer(0) : 0;
  if (shape.entries < 0 || bytes / static_cast<std::int64_t>(sizeof(float)) != shape.entries) return damaged(0);
  auto row =
      TRY(database.prepare("SELECT first_row, entry_counts, columns, entries, sigmas, hash FROM response_block "
                           "WHERE estimate = ? ORDER BY first_row"));
  row.with(estimate);
  RowCollector rows(shape);
  while (TRY(row.step())) {
    const BlockBytes block{row.integer(0), row.blob(1), row.blob(2), row.blob(3), row.blob(4)};
    if (block.digest() != row.integer(5) || !rows.add(block)) return damaged(block.first_row);
  }
  const std::int64_t end = rows.rows();
  auto response = std::move(rows).response();
  if (!response) return damaged(end);
  return response;
}

}  // namespace compueye::calib
