#pragma once

#include <vector>

#include "recon/core/bases/basis.hpp"
#include "recon/problem/response.hpp"

namespace compueye::recon {

/// ||A psi_j||_2 for every element psi_j of an orthonormal basis, in its order: N numbers. Differences are no basis;
/// for tv the DCT, in which D'D is diagonal, stands in for them. Takes a transform a seeing row: seconds for a large
/// eye.
[[nodiscard]] std::vector<double> atom_norms(const Response& response, BasisKind basis);

}  // namespace compueye::recon
