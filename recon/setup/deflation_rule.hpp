#pragma once

#include "recon/reconstructor.hpp"

namespace compueye::recon {

/// How many modes of A A' pdhg treats exactly: plan.rank when given, else 400 or a twelfth of the rows, at most all. On
/// the 80x80 eye (line art, DCT, sigma^2 = .1) 100, 200, 400 and 800 modes come within 5 % of the converged NMSE in
/// more than 40, 40, 18 and 13 iterations; each 400 cost a quarter of an iteration and .9 MB. On the 120x120 eye 400
/// and 800 take 50 and 29.
[[nodiscard]] int resolve_rank(const Plan& plan, int order) noexcept;

/// w: the share of the step bound that the basis takes, the modes of A take the rest: .18, .25 where every mode is
/// known, and .4 for total variation (80x80, sigma^2 = .1: .12, .18, .25 and .35 take 27, 27, 27 and 29 iterations in
/// the DCT, and within 10 % 22, 23, 24 and 25; .15, .4 and .6 take 42, 32 and 37 in total variation). In pixels there
/// is no such dual; a hundredth is left for the rounding of the modes.
[[nodiscard]] double basis_share(BasisKind basis, bool every_mode) noexcept;

}  // namespace compueye::recon
