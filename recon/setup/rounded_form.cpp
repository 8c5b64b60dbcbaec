#include "recon/setup/rounded_form.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "recon/setup/operator_list.hpp"
#include "recon/setup/quantised_response.hpp"
#include "recon/setup/wavelet_rounding.hpp"

namespace compueye::recon {
namespace {

bool streams(const Response& response) {
  if (response.nonzeros() < streamed_entries) return false;
  const auto exact = choose_operator(response.select_rows(response.seeing_rows()), std::nullopt);
  return exact && exact->kind == OperatorKind::dense_runs;
}

bool may_stand_for(const Response& response, const RoundedForm& form) {
  const bool wavelets = form.kind == OperatorKind::wavelet_runs;
  if (wavelets && worst_row_error(response, form.response) > most_row_error) return false;
  return keeps_details(response, form.response);
}

}  // namespace

std::optional<RoundedForm> rounded_form(const Response& response, std::optional<OperatorKind> asked) {
  if (asked && !is_lossy(*asked)) return std::nullopt;
  if (!asked && !(wavelets_fit(response) && streams(response))) return std::nullopt;
  const OperatorKind kind = asked.value_or(OperatorKind::wavelet_runs);
  RoundedForm form{kind, quantised(response, kind)};
  if (!may_stand_for(response, form)) return std::nullopt;
  return form;
}

bool is_rounded_in_wavelets(const Response& response) {
  if (!wavelets_fit(response) || response.nonzeros() < streamed_entries) return false;
  WaveletRows rows(response);
  std::vector<double> row(static_cast<std::size_t>(response.cols()), 0.0);
  for (const std::int32_t m : response.seeing_rows()) {
    response.for_each_in_row(m, [&](std::int32_t n, double v) { row[static_cast<std::size_t>(n)] = v; });
    rows.round(m);
    if (rows.picture() != row) return false;
    response.for_each_in_row(m, [&](std::int32_t n, double) { row[static_cast<std::size_t>(n)] = 0.0; });
  }
  return true;
}

}  // namespace compueye::recon
