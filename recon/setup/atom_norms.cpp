#include "recon/setup/atom_norms.hpp"

#include <algorithm>
#include <cmath>

#include "recon/setup/basis_list.hpp"

namespace compueye::recon {
namespace {

/// Those of A's columns, or the sums over its rows' squared transforms.
std::vector<double> squared_atom_norms(const Response& response, BasisKind basis) {
  const auto n = static_cast<std::size_t>(response.cols());
  std::vector<double> squares(n, 0.0), row(n, 0.0), coefficients(n);
  if (basis == BasisKind::identity) {
    for (int m = 0; m < response.rows(); ++m) {
      response.for_each_in_row(m, [&](std::int32_t k, double v) { squares[static_cast<std::size_t>(k)] += v * v; });
    }
    return squares;
  }
  KeptTables kept;
  const auto psi = make_basis<double>(basis == BasisKind::tv ? BasisKind::dct : basis, response.image_rows(),
                                      response.image_cols(), kept);
  std::vector<double> scratch(psi.scratch_size());
  for (const std::int32_t m : response.seeing_rows()) {
    std::fill(row.begin(), row.end(), 0.0);
    response.for_each_in_row(m, [&](std::int32_t k, double v) { row[static_cast<std::size_t>(k)] = v; });
    core::analyse(psi, row.data(), coefficients.data(), scratch.data());
    for (std::size_t k = 0; k < n; ++k) squares[k] += coefficients[k] * coefficients[k];
  }
  return squares;
}

}  // namespace

std::vector<double> atom_norms(const Response& response, BasisKind basis) {
  std::vector<double> norms = squared_atom_norms(response, basis);
  for (double& norm : norms) norm = std::sqrt(norm);
  return norms;
}

}  // namespace compueye::recon
