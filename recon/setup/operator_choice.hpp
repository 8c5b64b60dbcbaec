#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/result.hpp"
#include "recon/core/operators/linear_operator.hpp"
#include "recon/response.hpp"
#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// The form in which A is applied, and the mirror images that running sums are to use.
struct OperatorChoice {
  OperatorKind kind = OperatorKind::csr;
  MirrorSymmetry images;
  std::vector<std::int32_t> transposed;  ///< of find_diagonal_symmetry()
};

/// The quickest form for a response, by the number of entries, differences and run values: running sums where rows are
/// flat runs, dense runs where they are other runs, else dense or sparse. Never a lossy one. `asked` sets the form:
/// error unsupported, saying which would do, when running sums have no fewer differences than there are entries, the
/// picture is too small for a run or too large for running sums, or sparse entries outnumber 32 bits.
[[nodiscard]] hal::Result<OperatorChoice> choose_operator(const Response& seeing, std::optional<OperatorKind> asked);

}  // namespace compueye::recon
