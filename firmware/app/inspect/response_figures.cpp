#include "firmware/app/inspect/response_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/response_summary.hpp"
#include "firmware/app/inspect/duplicate_rows.hpp"
#include "firmware/app/inspect/largest_singular_value.hpp"
#include "firmware/app/inspect/operator_lines.hpp"
#include "firmware/text/number_text.hpp"
#include "recon/lambda_rule.hpp"
#include "recon/option_names.hpp"
#include "recon/reconstructor.hpp"
#include "recon/setup/mirror_symmetry.hpp"
#include "recon/setup/parity_classes.hpp"
#include "recon/setup/penalty_rule.hpp"

namespace compueye::firmware {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;
using recon::Response;

/// Beyond this the exact memory of admm is not worth the memory it takes to find out.
constexpr std::uint64_t most_factor_bytes = std::uint64_t{512} << 20U;

void add_shape(const Response& a, const calib::ResponseSummary& s, FigureList& figures) {
  const auto elements = static_cast<double>(a.rows()) * static_cast<double>(a.cols());
  const double density = static_cast<double>(s.entries) / elements;
  figures.add("channels", "response", fmt::format("{} rows x {} columns", grouped(a.rows()), grouped(a.cols())),
              a.rows());
  figures.add("pixels", "", "", a.cols());
  figures.add("stored_as", "stored as", a.is_dense() ? "dense" : "sparse rows", a.is_dense() ? "dense" : "sparse");
  figures.add("stored_entries", "", "", a.stored_entries());
  figures.add("entries", "non-zero entries",
              fmt::format("{} ({} %)", grouped(s.entries), significant(100.0 * density, 3)), s.entries);
  figures.add("density", "", "", density);
}

void add_support(const calib::ResponseSummary& s, int duplicates, FigureList& figures) {
  figures.add("blind_rows", "blind rows", grouped(s.blind_rows), s.blind_rows);
  figures.add("zero_columns", "unseen pixels", grouped(s.unseen_pixels()), s.unseen_pixels());
  figures.add("duplicate_rows", "duplicate rows", grouped(duplicates), duplicates);
  figures.add(
      "support", "pixels seen",
      fmt::format("{} to {} a row, median {:.6g}", grouped(s.support_min), grouped(s.support_max), s.support_median),
      {{"min", s.support_min}, {"median", s.support_median}, {"max", s.support_max}});
  figures.add("most_seen", "rows seeing a pixel", "at most " + grouped(s.most_seen), s.most_seen);
}

void add_ranges(const Response& a, FigureList& figures) {
  const auto [least, most] = std::minmax_element(a.values().begin(), a.values().end());
  figures.add("entry_range", "stored entries", fmt::format("{} to {}", significant(*least, 6), significant(*most, 6)),
              {*least, *most});
  const std::vector<double> sums = a.row_sums();
  std::vector<double> seeing;
  for (const std::int32_t m : a.seeing_rows()) seeing.push_back(sums[static_cast<std::size_t>(m)]);
  if (seeing.empty()) return;
  const auto [low, high] = std::minmax_element(seeing.begin(), seeing.end());
  figures.add("row_sums", "row sums (seeing rows)",
              fmt::format("{} to {} white pixels", significant(*low, 6), significant(*high, 6)), {*low, *high});
}

void add_symmetry(const Response& a, PictureSize size, FigureList& figures) {
  // As the solver's set-up does: blind rows have no place in the picture and so no mirror image.
  const std::size_t order = recon::find_mirror_symmetry(a.select_rows(a.seeing_rows()), size.rows, size.cols).order();
  figures.add("mirror_symmetry", "mirror symmetry",
              order == 4   ? "left-right and up-down (set-up is 16 times faster)"
              : order == 2 ? "one axis (set-up is 4 times faster)"
                           : "none",
              order);
}

/// Exact, from a reconstructor that is handed an empty factor instead of computing one.
Result<void> add_memory(const Response& a, PictureSize size, FigureList& figures) {
  const std::size_t seeing = a.seeing_rows().size();
  if (seeing == 0) return {};
  const recon::ParityClasses classes(static_cast<int>(seeing),
                                     recon::find_mirror_symmetry(a.select_rows(a.seeing_rows()), size.rows, size.cols));
  const std::size_t packed = recon::factor_size(classes);
  if (packed * sizeof(float) > most_factor_bytes) return {};
  const recon::Objective objective;
  recon::Plan plan;
  recon::Factor factor{recon::resolve_rho(a, size.rows, size.cols, objective, plan), static_cast<int>(seeing),
                       std::vector<float>(packed)};
  const auto made = recon::Reconstructor::create(a, size.rows, size.cols, objective, plan, std::move(factor));
  if (!made) return tl::unexpected(made.error());
  figures.add("rho_by_rule", "rho by rule", significant(made->plan().rho, 4), made->plan().rho);
  figures.add(
      "admm_memory", "memory of admm (f32)",
      fmt::format("{} tables (factor {}), {} workspace", bytes(made->table_bytes()), bytes(packed * sizeof(float)),
                  bytes(made->required_bytes())),
      {{"tables", made->table_bytes()}, {"factor", packed * sizeof(float)}, {"workspace", made->required_bytes()}});
  return {};
}

void add_lambda_scales(const Response& a, FigureList& figures) {
  const double norm = recon::lambda_scale(a, recon::BasisKind::identity);
  figures.add("median_column_norm", "median column norm", significant(norm, 6), norm);
  const double overlap = recon::lambda_scale(a, recon::BasisKind::dct);
  figures.add("mean_overlap", "mean column sum", significant(overlap, 6), overlap);
}

}  // namespace

Result<void> add_response_figures(const Response& a, std::optional<PictureSize> size, const recon::Progress& progress,
                                  FigureList& figures) {
  if (size && size->rows * size->cols != a.cols()) {
    return fail(ErrorCode::mismatch, "--size",
                fmt::format("{}x{} has {} pixels, the response has {} columns, expected them to be equal", size->rows,
                            size->cols, size->rows * size->cols, a.cols()));
  }
  const calib::ResponseSummary summary = calib::summarise(a);
  add_shape(a, summary, figures);
  add_support(summary, count_duplicate_rows(a), figures);
  if (a.stored_entries() > 0) add_ranges(a, figures);
  const SingularValue largest = largest_singular_value(a, progress);
  if (progress && !progress("norms", 0.0, 0.0)) {
    return fail(ErrorCode::interrupted, "inspect", "was stopped before it was complete");
  }
  figures.add("largest_singular_value", "largest singular value",
              significant(largest.value, 8) + (largest.settled ? "" : " (a lower bound: not settled)"), largest.value);
  figures.add("largest_singular_value_settled", "", "", largest.settled);
  add_lambda_scales(a, figures);
  if (!size || summary.seeing_rows() == 0) return {};
  add_symmetry(a, *size, figures);
  return add_operator_figures(a, size->rows, size->cols, std::nullopt, figures).and_then([&] {
    return add_memory(a, *size, figures);
  });
}

}  // namespace compueye::firmware
