#include "recon/setup/operator_list.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hal/try.hpp"
#include "recon/setup/dense_run_tables.hpp"
#include "recon/setup/operator_choice.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/running_sum_tables.hpp"

namespace compueye::recon {
namespace {

constexpr bool lossy = true;
constexpr std::array<OperatorRow, 8> rows{{
    {"dense", "dense", OperatorKind::dense},
    {"csr", "csr", OperatorKind::csr},
    {"running sums", "running-sums", OperatorKind::running_sums},
    {"running sums, four rows at once", "", OperatorKind::running_sums_symmetric},
    {"running sums, eight rows at once", "", OperatorKind::running_sums_diagonal},
    {"dense runs", "dense-runs", OperatorKind::dense_runs},
    {"dense runs in bf16", "dense-runs-bf16", OperatorKind::dense_runs_bf16, lossy},
    {"dense runs in int8", "dense-runs-int8", OperatorKind::dense_runs_int8, lossy},
}};

/// What only double can tell from nought would be a subnormal number in every product.
template <class T>
T kept_digits(double value) {
  return std::abs(value) < static_cast<double>(std::numeric_limits<T>::min()) ? T(0) : static_cast<T>(value);
}

template <class T>
void fill_dense(const Response& seeing, core::LinearOperator<T>& a, KeptTables& kept) {
  std::vector<T> values(a.rows * a.cols, T(0));
  for (int m = 0; m < seeing.rows(); ++m) {
    T* row = values.data() + static_cast<std::size_t>(m) * a.cols;
    seeing.for_each_in_row(m, [&](std::int32_t n, double v) { row[n] = kept_digits<T>(v); });
  }
  a.values = kept.keep(std::move(values));
}

template <class T>
void fill_sparse(const Response& seeing, core::LinearOperator<T>& a, KeptTables& kept) {
  std::vector<T> values;
  std::vector<std::int32_t> columns;
  std::vector<std::uint32_t> row_start{0};
  for (int m = 0; m < seeing.rows(); ++m) {
    seeing.for_each_in_row(m, [&](std::int32_t n, double v) {
      const T value = kept_digits<T>(v);
      if (value == T(0)) return;
      values.push_back(value);
      columns.push_back(n);
    });
    row_start.push_back(static_cast<std::uint32_t>(values.size()));
  }
  a.values = kept.keep(std::move(values));
  a.columns = kept.keep(std::move(columns));
  a.row_start = kept.keep(std::move(row_start));
}

core::RunValues run_values_of(OperatorKind kind) {
  if (kind == OperatorKind::dense_runs_bf16) return core::RunValues::bf16;
  return kind == OperatorKind::dense_runs_int8 ? core::RunValues::int8 : core::RunValues::full;
}

}  // namespace

std::span<const OperatorRow> operators() noexcept {
  return rows;
}

bool is_lossy(OperatorKind kind) noexcept {
  for (const OperatorRow& row : rows) {
    if (row.kind == kind) return row.lossy;
  }
  return false;
}

template <class T>
hal::Result<core::LinearOperator<T>> make_operator(const Response& seeing, std::optional<OperatorKind> asked,
                                                   KeptTables& kept) {
  const OperatorChoice chosen = TRY(choose_operator(seeing, asked));
  core::LinearOperator<T> a;
  a.kind = chosen.kind;
  a.rows = static_cast<std::size_t>(seeing.rows());
  a.cols = static_cast<std::size_t>(seeing.cols());
  switch (a.kind) {
    case OperatorKind::running_sums:
    case OperatorKind::running_sums_symmetric:
    case OperatorKind::running_sums_diagonal:
      a.sums = kept.keep_view(running_sum_tables<T>(seeing, chosen.images, chosen.transposed).value());
      break;
    case OperatorKind::dense_runs:
    case OperatorKind::dense_runs_bf16:
    case OperatorKind::dense_runs_int8:
      a.runs = kept.keep_view(dense_run_tables<T>(seeing, run_values_of(a.kind)).value());
      break;
    case OperatorKind::dense:
      fill_dense(seeing, a, kept);
      break;
    case OperatorKind::csr:
      fill_sparse(seeing, a, kept);
      break;
  }
  return a;
}

hal::Result<OperatorFigures> operator_figures(const Response& response, std::optional<OperatorKind> asked) {
  const Response applied = quantised(response, asked.value_or(OperatorKind::csr));
  KeptTables kept;
  const auto a = TRY(make_operator<float>(applied.select_rows(applied.seeing_rows()), asked, kept));
  return OperatorFigures{a.kind, core::bytes(a), core::flops(a)};
}

template hal::Result<core::LinearOperator<float>> make_operator(const Response&, std::optional<OperatorKind>,
                                                                KeptTables&);
template hal::Result<core::LinearOperator<double>> make_operator(const Response&, std::optional<OperatorKind>,
                                                                 KeptTables&);

}  // namespace compueye::recon
