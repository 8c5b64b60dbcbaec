#pragma once

#include <vector>

#include "recon/problem/response.hpp"

namespace compueye::recon {

/// ||a_m||^2 of every row.
[[nodiscard]] std::vector<double> squared_row_norms(const Response& response);

/// ||A||_F^2 with no row counted for more than 64 times the median of the rows that see: what a rule that asks how
/// strong the rows are has to go by, for one loud channel among a thousand says nothing about the others. That of an
/// eye without such rows is its ||A||_F^2.
[[nodiscard]] double bulk_squared_norm(const Response& response);

/// Powers of two that bring ||a_m||^2 + rho of such rows near that of the median, so that (S (A A' + rho I) S)^-1 is as
/// easy to keep as the inverse of the other rows alone; empty where rho is beyond them, or there is none. `seeing` has
/// no blind rows.
[[nodiscard]] std::vector<double> loud_row_scale(const Response& seeing, double rho);

}  // namespace compueye::recon
