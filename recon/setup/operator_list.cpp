#include "recon/setup/operator_list.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hal/try.hpp"
#include "recon/setup/dense_run_tables.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/running_sum_tables.hpp"
#include "recon/setup/wavelet_rounding.hpp"
#include "recon/setup/wavelet_run_tables.hpp"

namespace compueye::recon {
namespace {

constexpr bool lossy = true;
constexpr std::array<OperatorRow, 9> rows{{
    {"dense", "dense", OperatorKind::dense},
    {"csr", "csr", OperatorKind::csr},
    {"running sums", "running-sums", OperatorKind::running_sums},
    {"running sums, four rows at once", "", OperatorKind::running_sums_symmetric},
    {"running sums, eight rows at once", "", OperatorKind::running_sums_diagonal},
    {"dense runs", "dense-runs", OperatorKind::dense_runs},
    {"dense runs in bf16", "dense-runs-bf16", OperatorKind::dense_runs_bf16, lossy},
    {"dense runs in int8", "dense-runs-int8", OperatorKind::dense_runs_int8, lossy},
    {"wavelet runs", "wavelet-runs", OperatorKind::wavelet_runs, lossy},
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
    case OperatorKind::wavelet_runs:
      a.wavelet = kept.keep_view(wavelet_run_tables<T>(seeing));
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

namespace {

/// What one application takes, in loads of a sparse entry: dense rows are read seven times as fast an entry, a value of
/// dense runs somewhat less so, for a run has a beginning; a tap of a running sum, or of several at once, takes about
/// as long as a sparse entry, and folding and summing a picture about as long as 1.3 of them a pixel.
constexpr double dense_entry_cost = 0.15;
constexpr double run_value_cost = 0.2;
constexpr double fold_cost = 1.3;

hal::Result<OperatorChoice> refused(std::string why) {
  return hal::fail(hal::ErrorCode::unsupported, "operator", std::move(why));
}

/// Eight rows at once halve the taps of four and fold the picture twice.
OperatorChoice running_sums_of(const Response& seeing, double taps) {
  OperatorChoice choice{OperatorKind::running_sums, find_mirror_symmetry(seeing), {}};
  if (rows_sharing_tables(seeing.image_rows(), seeing.image_cols(), choice.images, {}) == 1) return choice;
  choice.kind = OperatorKind::running_sums_symmetric;
  if (taps / 8.0 < fold_cost * static_cast<double>(seeing.cols())) return choice;
  choice.transposed = find_diagonal_symmetry(seeing);
  if (rows_sharing_tables(seeing.image_rows(), seeing.image_cols(), choice.images, choice.transposed) == 8) {
    choice.kind = OperatorKind::running_sums_diagonal;
  }
  return choice;
}

hal::Result<OperatorChoice> as_asked(const Response& seeing, OperatorKind kind) {
  constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();  // row starts are 32 bits wide
  const std::int64_t entries = seeing.nonzeros();
  switch (kind) {
    case OperatorKind::dense:
      return OperatorChoice{kind, {}, {}};
    case OperatorKind::csr:
      if (entries > most) {
        return refused("csr numbers at most " + std::to_string(most) + " entries, the response has " +
                       std::to_string(entries) + "; expected dense-runs");
      }
      return OperatorChoice{kind, {}, {}};
    case OperatorKind::running_sums:
    case OperatorKind::running_sums_symmetric:
    case OperatorKind::running_sums_diagonal: {
      if (!running_sums_fit(seeing.image_rows(), seeing.image_cols())) {
        return refused(
            "running sums number at most 65536 pixels in a quarter of the picture; expected dense-runs or csr");
      }
      const std::int64_t taps = running_sum_taps(seeing);
      if (taps >= entries) {
        return refused("running sums of this response have " + std::to_string(taps) + " differences for " +
                       std::to_string(entries) +
                       " entries, for its rows are not flat; expected dense-runs, csr or dense");
      }
      return running_sums_of(seeing, static_cast<double>(taps));
    }
    case OperatorKind::dense_runs:
    case OperatorKind::dense_runs_bf16:
    case OperatorKind::dense_runs_int8:
      if (seeing.cols() < least_run_pixels) {
        return refused("a run has at least " + std::to_string(least_run_pixels) + " pixels, the picture has " +
                       std::to_string(seeing.cols()) + "; expected dense or csr");
      }
      return OperatorChoice{kind, {}, {}};
    case OperatorKind::wavelet_runs:
      if (!wavelets_fit(seeing)) {
        return refused("wavelet runs want a picture of " + std::to_string(least_wavelet_side) +
                       " pixels a side or more, this one has " + std::to_string(seeing.image_rows()) + " x " +
                       std::to_string(seeing.image_cols()) + "; expected dense-runs, dense or csr");
      }
      return OperatorChoice{kind, {}, {}};
  }
  return refused("is none that exists");
}

}  // namespace

hal::Result<OperatorChoice> choose_operator(const Response& seeing, std::optional<OperatorKind> asked) {
  if (asked) return as_asked(seeing, *asked);
  const auto sparse = static_cast<double>(seeing.nonzeros()), pixels = static_cast<double>(seeing.cols());
  const double dense = dense_entry_cost * static_cast<double>(seeing.rows()) * pixels;
  const bool sums_fit = running_sums_fit(seeing.image_rows(), seeing.image_cols());
  const double taps = sums_fit ? static_cast<double>(running_sum_taps(seeing)) : 0.0;
  // A run holds every entry, so there is no need to lay out runs where four rows at once beat them at their best.
  if (sums_fit && taps / 4.0 + pixels < std::min(dense, run_value_cost * sparse)) {
    OperatorChoice sums = running_sums_of(seeing, taps);
    if (sums.kind != OperatorKind::running_sums) return sums;
  }
  double least = std::min(dense, sparse);
  OperatorKind plain = dense < sparse ? OperatorKind::dense : OperatorKind::csr;
  const double runs = run_value_cost * static_cast<double>(dense_run_values(seeing));
  if (runs < least) {
    least = runs;
    plain = OperatorKind::dense_runs;
  }
  if (sums_fit && taps / 4.0 + pixels < least) {
    OperatorChoice sums = running_sums_of(seeing, taps);
    if (sums.kind != OperatorKind::running_sums || taps + pixels < least) return sums;
  }
  return as_asked(seeing, plain);
}

}  // namespace compueye::recon
