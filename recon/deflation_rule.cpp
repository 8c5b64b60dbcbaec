#include "recon/deflation_rule.hpp"

#include <algorithm>

namespace compueye::recon {
namespace {

constexpr int rank_by_rule = 400;

}  // namespace

int resolve_rank(const Plan& plan, int order) noexcept {
  return std::min(order, plan.rank > 0 ? plan.rank : rank_by_rule);
}

double basis_share(BasisKind basis) noexcept {
  if (basis == BasisKind::identity) return 0.01;
  return basis == BasisKind::tv ? 0.4 : 0.25;
}

}  // namespace compueye::recon
