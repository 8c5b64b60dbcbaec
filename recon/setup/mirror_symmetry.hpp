#pragma once

#include <cstdint>
#include <vector>

#include "recon/response.hpp"

namespace compueye::recon {

/// The mirror images that leave a response unchanged: flipping the picture about an axis only permutes the rows of A.
/// An eye on a regular lattice has both; a measured eye has none, and is its own only image.
struct MirrorSymmetry {
  /// 1, 2 or 4 permutations of the rows; the first is the identity, each is its own inverse and any two commute.
  std::vector<std::vector<std::int32_t>> permutations;
  /// characters[c][g] = +-1: the sign that parity class c takes under permutation g.
  std::vector<std::vector<int>> characters;

  [[nodiscard]] std::size_t order() const noexcept { return permutations.size(); }
};

/// Looks for left-right and up-down symmetry of a response on its picture; one that does not know its picture has none.
/// Entries may differ by 1e-11 of the largest.
[[nodiscard]] MirrorSymmetry find_mirror_symmetry(const Response& response);

/// Looks for symmetry about the diagonal of a square picture: the row that is the transposed image of each row, its own
/// inverse; empty where there is none. Entries may differ as above.
[[nodiscard]] std::vector<std::int32_t> find_diagonal_symmetry(const Response& response);

}  // namespace compueye::recon
