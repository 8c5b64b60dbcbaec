#include "recon/setup/operator_figures.hpp"

#include "recon/setup/problem_tables.hpp"
#include "recon/setup/quantised_response.hpp"

namespace compueye::recon {

hal::Result<OperatorFigures> operator_figures(const Response& response, std::optional<OperatorKind> asked) {
  const Response applied = quantised(response, asked.value_or(OperatorKind::csr));
  OwnedTables<float> tables;
  return fill_operator(applied.select_rows(applied.seeing_rows()), asked, tables).map([&] {
    const core::LinearOperator<float>& a = tables.problem.a;
    return OperatorFigures{a.kind, core::bytes(a), core::flops(a)};
  });
}

}  // namespace compueye::recon
