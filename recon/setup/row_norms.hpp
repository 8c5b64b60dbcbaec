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

/// Powers of two that bring the rows beyond that near the median, so that (S A A' S + rho S^2)^-1 is as easy to keep as
/// the inverse of the other rows alone; empty where there is no such row. `seeing` has no blind rows.
[[nodiscard]] std::vector<double> loud_row_scale(const Response& seeing);

}  // namespace compueye::recon
