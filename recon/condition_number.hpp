#pragma once

#include "recon/problem/response.hpp"

namespace compueye::recon {

/// Largest over least of the min(M, N) singular values of the seeing rows, in double and without squaring A: good to
/// about 1e15, and infinite where the least is 0. Dense, cubic in min(M, N): for small eyes.
[[nodiscard]] double condition_number(const Response& response);

}  // namespace compueye::recon
