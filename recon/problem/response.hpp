#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hal/result.hpp"

namespace compueye::recon {

enum class OperatorKind : std::uint8_t;

/// The measurement matrix A (M x N) of an eye: row m holds what every pixel gives to ommatidium m, in the unit "one
/// fully seen pixel at white". A value type: nominal, measured, fitted or somebody else's, they are all one of these.
/// Held in double for set-up, calibration and references; operators for the frame path are made from it in float32.
class Response {
 public:
  /// `values` row-major, rows * cols of them. Errors: out_of_range (empty, or a NaN or infinity, named by row and
  /// column), mismatch (size).
  [[nodiscard]] static hal::Result<Response> from_dense(int rows, int cols, std::vector<double> values);

  /// Compressed sparse rows: row m has entries row_start[m] .. row_start[m+1]-1, columns strictly ascending.
  [[nodiscard]] static hal::Result<Response> from_csr(int rows, int cols, std::vector<std::int64_t> row_start,
                                                      std::vector<std::int32_t> columns, std::vector<double> values);

  /// The same matrix, said to be of a picture of image_rows x image_cols pixels, row-major; 0 x 0: not known.
  /// Error: mismatch (not as many pixels as there are columns).
  [[nodiscard]] hal::Result<Response> with_image(int image_rows, int image_cols) &&;
  [[nodiscard]] hal::Result<Response> with_image(int image_rows, int image_cols) const& {
    return Response(*this).with_image(image_rows, image_cols);
  }

  /// The same entries, said to be what rounding for a lossy form of A left; those who round tell, so that nobody has to
  /// find out, or rounds again.
  [[nodiscard]] Response said_to_be_rounded_for(OperatorKind kind) && {
    rounded_for_ = kind;
    return std::move(*this);
  }
  /// Nothing: the entries are as they were given.
  [[nodiscard]] std::optional<OperatorKind> rounded_for() const noexcept { return rounded_for_; }

  [[nodiscard]] int rows() const noexcept { return rows_; }              ///< M
  [[nodiscard]] int cols() const noexcept { return cols_; }              ///< N
  [[nodiscard]] int image_rows() const noexcept { return image_rows_; }  ///< 0: not known, as of a bare matrix file
  [[nodiscard]] int image_cols() const noexcept { return image_cols_; }  ///< image_rows * image_cols = N where known
  [[nodiscard]] bool is_dense() const noexcept { return row_start_.empty(); }
  /// Stored entries: rows*cols when dense.
  [[nodiscard]] std::int64_t stored_entries() const noexcept { return static_cast<std::int64_t>(values_->size()); }
  /// Entries with a magnitude above `above`.
  [[nodiscard]] std::int64_t nonzeros(double above = 0.0) const noexcept;

  /// Row-major values of a dense response; the stored values, row after row, of a sparse one.
  [[nodiscard]] std::span<const double> values() const noexcept { return *values_; }
  [[nodiscard]] std::span<const std::int64_t> row_start() const noexcept {
    return row_start_;
  }                                                                                           ///< M+1; empty if dense
  [[nodiscard]] std::span<const std::int32_t> columns() const noexcept { return *columns_; }  ///< empty if dense

  /// Calls visit(column, value) for every stored entry of row m, columns ascending.
  template <class Visitor>
  void for_each_in_row(int m, Visitor&& visit) const {
    const auto row = static_cast<std::size_t>(m);
    const auto width = static_cast<std::size_t>(cols_);
    const std::size_t begin = is_dense() ? row * width : static_cast<std::size_t>(row_start_[row]);
    const std::size_t end = is_dense() ? begin + width : static_cast<std::size_t>(row_start_[row + 1]);
    const double* values = values_->data();
    const std::int32_t* columns = columns_->data();
    for (std::size_t e = begin; e < end; ++e) {
      visit(is_dense() ? static_cast<std::int32_t>(e - begin) : columns[e], values[e]);
    }
  }

  /// y = A x and x = A' y in double; y has M, x has N entries.
  void forward(std::span<const double> x, std::span<double> y) const;
  void adjoint(std::span<const double> y, std::span<double> x) const;

  /// ||A||_F^2
  [[nodiscard]] double squared_norm() const noexcept { return squared_norm_; }

  /// Sum of each row: what an ommatidium reads from an all-white scene.
  [[nodiscard]] std::vector<double> row_sums() const;

  /// Rows that see something. Blind rows carry no information about x and are dropped by every solver.
  [[nodiscard]] std::vector<std::int32_t> seeing_rows() const;

  /// The given rows, each multiplied by its factor (`scale` empty: by 1). Rows may not repeat. Where that leaves out
  /// nothing but empty rows of a sparse response, the entries are shared, not copied. Rounded ones stay so by powers of
  /// two.
  [[nodiscard]] Response select_rows(std::span<const std::int32_t> rows, std::span<const double> scale = {}) const;

  /// The given rows (ascending) empty, the others as they are, in sparse form: a dead ommatidium tells nothing, and
  /// with an empty row every solver leaves it out.
  [[nodiscard]] Response without_rows(std::span<const int> rows) const;

  /// 64-bit content hash over shape and every stored entry; keys everything that was computed from this A. The picture
  /// is no part of it.
  [[nodiscard]] std::uint64_t content_hash() const;

 private:
  Response() = default;
  void hold(std::vector<std::int32_t> columns, std::vector<double> values);
  [[nodiscard]] bool only_empty_left_out(std::span<const std::int32_t> rows) const noexcept;
  int rows_ = 0;
  int cols_ = 0;
  int image_rows_ = 0;
  int image_cols_ = 0;
  double squared_norm_ = 0.0;
  std::optional<OperatorKind> rounded_for_;
  std::vector<std::int64_t> row_start_;
  /// Never changed, so that copies share them: they are a hundred megabytes of a large eye.
  std::shared_ptr<const std::vector<std::int32_t>> columns_;
  std::shared_ptr<const std::vector<double>> values_;
};

}  // namespace compueye::recon
