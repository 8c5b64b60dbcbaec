#include "recon/problem/response.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "hal/try.hpp"
#include "xxhash.h"

namespace compueye::recon {
namespace {

using hal::ErrorCode;
using hal::fail;

constexpr const char* place = "response";

hal::Result<void> check_shape(int rows, int cols) {
  if (rows >= 1 && cols >= 1) return {};
  return fail(
      ErrorCode::out_of_range, place,
      "is " + std::to_string(rows) + " x " + std::to_string(cols) + ", expected at least one row and one column");
}

bool is_power_of_two(double factor) noexcept {
  int exponent = 0;
  return std::frexp(factor, &exponent) == 0.5;
}

tl::unexpected<hal::Error> not_finite(std::int64_t row, std::int64_t col, double value) {
  return fail(ErrorCode::out_of_range, place,
              "entry (" + std::to_string(row) + ", " + std::to_string(col) + ") is " + std::to_string(value) +
                  ", expected a finite number (rows and columns from 0)");
}

hal::Result<void> check_row(std::int64_t row, int cols, std::span<const std::int32_t> columns,
                            std::span<const double> values) {
  for (std::size_t e = 0; e < columns.size(); ++e) {
    const std::int32_t col = columns[e];
    if (col < 0 || col >= cols || (e > 0 && col <= columns[e - 1])) {
      return fail(ErrorCode::bad_format, place,
                  "row " + std::to_string(row) + " has column " + std::to_string(col) +
                      ", expected ascending columns from 0 to " + std::to_string(cols - 1));
    }
    if (!std::isfinite(values[e])) return not_finite(row, col, values[e]);
  }
  return {};
}

}  // namespace

hal::Result<Response> Response::from_dense(int rows, int cols, std::vector<double> values) {
  TRY(check_shape(rows, cols));
  if (values.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols)) {
    return fail(ErrorCode::mismatch, place,
                "has " + std::to_string(values.size()) + " values, expected " + std::to_string(rows) + " x " +
                    std::to_string(cols));
  }
  const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
  if (bad != values.end()) {
    const std::int64_t at = bad - values.begin();
    return not_finite(at / cols, at % cols, *bad);
  }
  Response r;
  r.rows_ = rows;
  r.cols_ = cols;
  r.hold({}, std::move(values));
  return r;
}

hal::Result<Response> Response::from_csr(int rows, int cols, std::vector<std::int64_t> row_start,
                                         std::vector<std::int32_t> columns, std::vector<double> values) {
  TRY(check_shape(rows, cols));
  const auto entries = static_cast<std::int64_t>(values.size());
  if (row_start.size() != static_cast<std::size_t>(rows) + 1 || columns.size() != values.size() ||
      row_start.front() != 0 || row_start.back() != entries || !std::is_sorted(row_start.begin(), row_start.end())) {
    return fail(ErrorCode::mismatch, place, "row starts, columns and values do not describe the same matrix");
  }
  for (int m = 0; m < rows; ++m) {
    const auto begin = static_cast<std::size_t>(row_start[static_cast<std::size_t>(m)]);
    const auto count = static_cast<std::size_t>(row_start[static_cast<std::size_t>(m) + 1]) - begin;
    TRY(check_row(m, cols, std::span(columns).subspan(begin, count), std::span(values).subspan(begin, count)));
  }
  Response r;
  r.rows_ = rows;
  r.cols_ = cols;
  r.row_start_ = std::move(row_start);
  r.hold(std::move(columns), std::move(values));
  return r;
}

hal::Result<Response> Response::with_image(int image_rows, int image_cols) && {
  const bool unknown = image_rows == 0 && image_cols == 0;
  const std::int64_t pixels = static_cast<std::int64_t>(image_rows) * image_cols;
  if (!unknown && (image_rows < 1 || image_cols < 1 || pixels != cols_)) {
    return fail(ErrorCode::mismatch, "size",
                std::to_string(image_rows) + "x" + std::to_string(image_cols) + " has " + std::to_string(pixels) +
                    " pixels, the response has " + std::to_string(cols_) + " columns");
  }
  image_rows_ = image_rows;
  image_cols_ = image_cols;
  return std::move(*this);
}

void Response::hold(std::vector<std::int32_t> columns, std::vector<double> values) {
  squared_norm_ = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  columns_ = std::make_shared<const std::vector<std::int32_t>>(std::move(columns));
  values_ = std::make_shared<const std::vector<double>>(std::move(values));
}

std::int64_t Response::nonzeros(double above) const noexcept {
  return std::count_if(values_->begin(), values_->end(), [above](double v) { return std::abs(v) > above; });
}

void Response::forward(std::span<const double> x, std::span<double> y) const {
  for (int m = 0; m < rows_; ++m) {
    double sum = 0.0;
    for_each_in_row(m, [&](std::int32_t col, double value) { sum += value * x[static_cast<std::size_t>(col)]; });
    y[static_cast<std::size_t>(m)] = sum;
  }
}

void Response::adjoint(std::span<const double> y, std::span<double> x) const {
  std::fill(x.begin(), x.end(), 0.0);
  for (int m = 0; m < rows_; ++m) {
    const double scale = y[static_cast<std::size_t>(m)];
    for_each_in_row(m, [&](std::int32_t col, double value) { x[static_cast<std::size_t>(col)] += value * scale; });
  }
}

std::vector<double> Response::row_sums() const {
  std::vector<double> sums(static_cast<std::size_t>(rows_), 0.0);
  for (int m = 0; m < rows_; ++m) {
    for_each_in_row(m, [&](std::int32_t, double value) { sums[static_cast<std::size_t>(m)] += value; });
  }
  return sums;
}

std::vector<std::int32_t> Response::seeing_rows() const {
  std::vector<std::int32_t> seeing;
  for (int m = 0; m < rows_; ++m) {
    bool sees = false;
    for_each_in_row(m, [&](std::int32_t, double value) { sees = sees || value != 0.0; });
    if (sees) seeing.push_back(m);
  }
  return seeing;
}

/// Whether `rows` are in order and hold every entry there is.
bool Response::only_empty_left_out(std::span<const std::int32_t> rows) const noexcept {
  if (is_dense()) return false;
  std::int64_t next = 0;
  for (const std::int32_t m : rows) {
    const auto row = static_cast<std::size_t>(m);
    if (row_start_[row] != next) return false;
    next = row_start_[row + 1];
  }
  return next == stored_entries();
}

Response Response::select_rows(std::span<const std::int32_t> rows, std::span<const double> scale) const {
  Response r;
  r.rows_ = static_cast<int>(rows.size());
  r.cols_ = cols_;
  r.image_rows_ = image_rows_;
  r.image_cols_ = image_cols_;
  if (std::all_of(scale.begin(), scale.end(), is_power_of_two)) r.rounded_for_ = rounded_for_;
  if (!is_dense()) r.row_start_.push_back(0);
  if (scale.empty() && only_empty_left_out(rows)) {
    for (const std::int32_t m : rows) r.row_start_.push_back(row_start_[static_cast<std::size_t>(m) + 1]);
    r.columns_ = columns_;
    r.values_ = values_;
    r.squared_norm_ = squared_norm_;
    return r;
  }
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  columns.reserve(columns_->size());
  values.reserve(values_->size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double factor = scale.empty() ? 1.0 : scale[i];
    for_each_in_row(rows[i], [&](std::int32_t col, double value) {
      values.push_back(value * factor);
      if (!is_dense()) columns.push_back(col);
    });
    if (!is_dense()) r.row_start_.push_back(static_cast<std::int64_t>(values.size()));
  }
  r.hold(std::move(columns), std::move(values));
  return r;
}

Response Response::without_rows(std::span<const int> rows) const {
  Response r;
  r.rows_ = rows_;
  r.cols_ = cols_;
  r.image_rows_ = image_rows_;
  r.image_cols_ = image_cols_;
  r.rounded_for_ = rounded_for_;
  r.row_start_.push_back(0);
  std::vector<std::int32_t> columns;
  std::vector<double> values;
  columns.reserve(values_->size());
  values.reserve(values_->size());
  for (int m = 0; m < rows_; ++m) {
    if (!std::binary_search(rows.begin(), rows.end(), m)) {
      for_each_in_row(m, [&](std::int32_t col, double value) {
        columns.push_back(col);
        values.push_back(value);
      });
    }
    r.row_start_.push_back(static_cast<std::int64_t>(values.size()));
  }
  r.hold(std::move(columns), std::move(values));
  return r;
}

std::uint64_t Response::content_hash() const {
  const std::int64_t shape[3] = {rows_, cols_, is_dense() ? 1 : 0};
  XXH64_hash_t hash = XXH3_64bits(shape, sizeof shape);
  hash = XXH3_64bits_withSeed(row_start_.data(), row_start_.size() * sizeof(std::int64_t), hash);
  hash = XXH3_64bits_withSeed(columns_->data(), columns_->size() * sizeof(std::int32_t), hash);
  return XXH3_64bits_withSeed(values_->data(), values_->size() * sizeof(double), hash);
}

}  // namespace compueye::recon
