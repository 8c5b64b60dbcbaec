#include "firmware/app/commands/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "calib/response_summary.hpp"
#include "hal/try.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/option_names.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/operator_list.hpp"
#include "recon/setup/penalty_rule.hpp"
#include "recon/setup/shorter_side.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;
using recon::Response;

using Row = std::vector<std::pair<std::int32_t, double>>;

void take_row(const recon::Response& response, int m, Row& row) {
  row.clear();
  response.for_each_in_row(m, [&](std::int32_t n, double value) {
    if (value != 0.0) row.emplace_back(n, value);
  });
}

/// Mixes as FNV-1a does, a number at a time.
std::uint64_t hash_of(const Row& row) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  const auto mix = [&hash](std::uint64_t bits) {
    hash = (hash ^ bits) * 0x100000001B3U;
    hash ^= hash >> 29U;
  };
  for (const auto& [column, value] : row) {
    mix(static_cast<std::uint64_t>(column));
    mix(std::bit_cast<std::uint64_t>(value));
  }
  return hash;
}

/// Seeing rows that equal an earlier one, entry for entry: they measure the same thing twice.
int count_duplicate_rows(const recon::Response& response) {
  std::unordered_map<std::uint64_t, std::vector<int>> first_rows;
  Row row, other;
  int duplicates = 0;
  for (int m = 0; m < response.rows(); ++m) {
    take_row(response, m, row);
    if (row.empty()) continue;
    std::vector<int>& alike = first_rows[hash_of(row)];
    const bool seen = std::any_of(alike.begin(), alike.end(), [&](int earlier) {
      take_row(response, earlier, other);
      return other == row;
    });
    if (seen) {
      ++duplicates;
    } else {
      alike.push_back(m);
    }
  }
  return duplicates;
}

struct SingularValue {
  double value = 0.0;  ///< a lower bound that grows with every iteration
  int iterations = 0;
  bool settled = false;  ///< the last iteration changed it by less than 1e-9 of itself
};

constexpr int most_iterations = 300;
constexpr double settled_change = 1e-9;

double length_of(std::span<const double> v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

/// No symmetry, no zeros and no period, so that it is orthogonal to no singular vector that a real eye has.
std::vector<double> start_vector(std::size_t size) {
  constexpr double golden = 0.6180339887498949;
  std::vector<double> v(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double turns = golden * static_cast<double>(i + 1);
    v[i] = 0.5 + (turns - std::floor(turns));
  }
  return v;
}

/// The largest singular value of A, which is the norm of A and the square root of the gradient's Lipschitz constant:
/// power iteration on A'A from a fixed start, at most 300 times (Golub & Van Loan, "Matrix Computations", 4th
/// ed., 8.2.1). `progress` may stop it early, not settled.
SingularValue largest_singular_value(const recon::Response& a, const recon::Progress& progress) {
  SingularValue found;
  std::vector<double> x = start_vector(static_cast<std::size_t>(a.cols()));
  std::vector<double> y(static_cast<std::size_t>(a.rows()));
  while (found.iterations < most_iterations && !found.settled) {
    const double length = length_of(x);
    if (!(length > 0.0) || !std::isfinite(length)) break;
    for (double& each : x) each /= length;
    a.forward(x, y);
    const double before = found.value;
    found.value = length_of(y);
    ++found.iterations;
    found.settled = std::abs(found.value - before) <= settled_change * found.value;
    a.adjoint(y, x);
    if (progress && !progress("largest singular value", found.iterations, most_iterations)) break;
  }
  return found;
}

/// Beyond this the exact memory of admm is not worth the memory it takes to find out.
constexpr std::uint64_t most_factor_bytes = std::uint64_t{512} << 20U;

void add_shape(const Response& a, const calib::ResponseSummary& s, Figures& figures) {
  const auto elements = static_cast<double>(a.rows()) * static_cast<double>(a.cols());
  const double density = static_cast<double>(s.entries) / elements;
  figures.add("channels", a.rows()).add("pixels", a.cols());
  figures.line("response", "{channels:,} rows x {pixels:,} columns");
  figures.add("stored_as", a.is_dense() ? "dense" : "sparse", "stored as", a.is_dense() ? "dense" : "sparse rows");
  figures.add("stored_entries", a.stored_entries()).add("entries", s.entries).add("density", density);
  figures.line("non-zero entries", "{entries:,} ({density:3%})");
}

void add_support(const calib::ResponseSummary& s, int duplicates, Figures& figures) {
  figures.add("blind_rows", s.blind_rows, "blind rows", "{:,}");
  figures.add("zero_columns", s.unseen_pixels(), "unseen pixels", "{:,}");
  figures.add("duplicate_rows", duplicates, "duplicate rows", "{:,}");
  figures.add("support", Figures{{"min", s.support_min}, {"median", s.support_median}, {"max", s.support_max}},
              "pixels seen", "{support.min:,} to {support.max:,} a row, median {support.median}");
  figures.add("most_seen", s.most_seen, "rows seeing a pixel", "at most {:,}");
}

void add_ranges(const Response& a, Figures& figures) {
  const auto [least, most] = std::minmax_element(a.values().begin(), a.values().end());
  figures.add("entry_range", std::vector<double>{*least, *most}, "stored entries",
              "{entry_range.0:6} to {entry_range.1:6}");
  const std::vector<double> sums = a.row_sums();
  std::vector<double> seeing;
  for (const std::int32_t m : a.seeing_rows()) seeing.push_back(sums[static_cast<std::size_t>(m)]);
  if (seeing.empty()) return;
  const auto [low, high] = std::minmax_element(seeing.begin(), seeing.end());
  figures.add("row_sums", std::vector<double>{*low, *high}, "row sums (seeing rows)",
              "{row_sums.0:6} to {row_sums.1:6} white pixels");
}

void add_symmetry(const Response& a, Figures& figures) {
  // As the solver's set-up does: blind rows have no place in the picture and so no mirror image.
  const std::size_t order = recon::find_mirror_symmetry(a.select_rows(a.seeing_rows())).order();
  figures.add("mirror_symmetry", order, "mirror symmetry",
              order == 4   ? "left-right and up-down (set-up is 16 times faster)"
              : order == 2 ? "one axis (set-up is 4 times faster)"
                           : "none");
}

/// Exact, from a reconstructor that is handed an empty factor instead of computing one, but for that of a tall
/// response.
Result<void> add_memory(const Response& a, Figures& figures) {
  const std::size_t seeing = a.seeing_rows().size();
  if (seeing == 0) return {};
  const recon::ParityClasses classes(static_cast<int>(seeing),
                                     recon::find_mirror_symmetry(a.select_rows(a.seeing_rows())));
  const auto pixels = static_cast<std::size_t>(a.cols()), triangle = pixels * (pixels + 1) / 2;
  const bool tall = recon::is_tall(static_cast<int>(seeing), a.cols());
  const std::size_t bytes = tall ? 2 * triangle * sizeof(double) : recon::factor_size(classes) * sizeof(float);
  if (bytes > most_factor_bytes) return {};
  const recon::Objective objective;
  recon::Plan plan;
  std::optional<recon::Factor> factor;
  if (!tall) {
    factor = recon::Reconstructor::wanted_factor(a, objective, plan);
    factor->values.resize(recon::factor_size(classes));
  }
  const auto made = TRY(recon::Reconstructor::create(a, objective, plan, std::move(factor)));
  figures.add("rho_by_rule", made.plan().rho, "rho by rule", "{:4}");
  figures.add("admm_memory",
              Figures{{"tables", made.table_bytes()}, {"factor", bytes}, {"workspace", made.required_bytes()}},
              "memory of admm (f32)",
              "{admm_memory.tables:bytes} tables (factor {admm_memory.factor:bytes}), {admm_memory.workspace:bytes} "
              "workspace");
  return {};
}

void add_lambda_scales(const Response& a, Figures& figures) {
  figures.add("median_column_norm", recon::lambda_scale(a, recon::BasisKind::identity), "median column norm", "{:6}");
  figures.add("mean_overlap", recon::lambda_scale(a, recon::BasisKind::dct), "mean column sum", "{:6}");
}

}  // namespace

hal::Result<void> add_operator_figures(const recon::Response& response, std::optional<recon::OperatorKind> asked,
                                       Figures& figures) {
  const auto found = TRY(recon::operator_figures(response, asked));
  figures.add("operator", recon::name(found.kind), "operator (how A is applied)", asked ? "{}" : "{} (by rule)");
  figures.add("operator_cost", Figures{{"bytes", found.bytes}, {"flops", found.flops}}, "A x, and as much A' y",
              "{operator_cost.bytes:bytes} of tables, {operator_cost.flops:,} multiply-adds");
  return {};
}

Result<void> add_response_figures(Response a, std::optional<PictureSize> size, const recon::Progress& progress,
                                  Figures& figures) {
  if (size && size->rows * size->cols != a.cols()) {
    return fail(ErrorCode::mismatch, "--size",
                fmt::format("{}x{} has {} pixels, the response has {} columns, expected them to be equal", size->rows,
                            size->cols, size->rows * size->cols, a.cols()));
  }
  if (size) a = TRY(std::move(a).with_image(size->rows, size->cols));
  const calib::ResponseSummary summary = calib::summarise(a);
  add_shape(a, summary, figures);
  add_support(summary, count_duplicate_rows(a), figures);
  if (a.stored_entries() > 0) add_ranges(a, figures);
  const SingularValue largest = largest_singular_value(a, progress);
  if (progress && !progress("norms", 0.0, 0.0)) {
    return fail(ErrorCode::interrupted, "inspect", "was stopped before it was complete");
  }
  figures.add("largest_singular_value", largest.value, "largest singular value",
              largest.settled ? "{:8}" : "{:8} (a lower bound: not settled)");
  figures.add("largest_singular_value_settled", largest.settled);
  add_lambda_scales(a, figures);
  if (!size || summary.seeing_rows() == 0) return {};
  add_symmetry(a, figures);
  TRY(add_operator_figures(a, std::nullopt, figures));
  return add_memory(a, figures);
}

}  // namespace compueye::firmware
