#include "recon/setup/deflation_rule.hpp"

#include <algorithm>

namespace compueye::recon {
namespace {

constexpr int least_by_rule = 400;
constexpr int rows_a_mode = 12;

}  // namespace

int resolve_rank(const Plan& plan, int order) noexcept {
  return std::min(order, plan.rank > 0 ? plan.rank : std::max(least_by_rule, order / rows_a_mode));
}

double basis_share(BasisKind basis, bool every_mode) noexcept {
  if (basis == BasisKind::identity) return 0.01;
  if (basis == BasisKind::tv) return 0.4;
  return every_mode ? 0.25 : 0.18;
}

}  // namespace compueye::recon
