#include "recon/setup/rounded_form.hpp"

#include <utility>

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
  if (const auto kind = response.rounded_for(); kind && kind == asked.value_or(*kind))
    return RoundedForm{*kind, response};
  if (!asked && !(wavelets_fit(response) && streams(response))) return std::nullopt;
  const OperatorKind kind = asked.value_or(OperatorKind::wavelet_runs);
  RoundedForm form{kind, quantised(response, kind)};
  if (!may_stand_for(response, form)) return std::nullopt;
  return form;
}

std::optional<OperatorKind> applied_operator(const std::optional<RoundedForm>& form,
                                             std::optional<OperatorKind> asked) noexcept {
  if (form) return form->kind;
  return asked && is_lossy(*asked) ? std::nullopt : asked;
}

}  // namespace compueye::recon
