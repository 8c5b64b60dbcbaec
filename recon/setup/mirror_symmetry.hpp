#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "recon/problem/response.hpp"

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

/// The rows of a mirror symmetric A by parity: a matrix over its rows that every flip leaves unchanged is four
/// independent blocks of a quarter the order. A row and its mirror images are an orbit; in class c an orbit has one
/// unit vector, whose entry at its row m is share(c, m), or none at all. A measured eye has one class, with every row
/// an orbit.
class ParityClasses {
 public:
  ParityClasses(int rows, MirrorSymmetry symmetry);
  /// One class, whatever mirrors there are.
  explicit ParityClasses(int rows);

  struct Orbit {
    int first = 0;       ///< its lowest row
    int stabiliser = 1;  ///< how many permutations leave that row where it is
    double component = 0.0;
  };

  [[nodiscard]] int rows() const noexcept { return static_cast<int>(places_.size()); }
  [[nodiscard]] std::size_t count() const noexcept { return positions_.size(); }
  /// Order of block c.
  [[nodiscard]] int order(std::size_t c) const noexcept { return orders_[c]; }
  [[nodiscard]] const std::vector<Orbit>& orbits() const noexcept { return orbits_; }
  [[nodiscard]] const MirrorSymmetry& symmetry() const noexcept { return symmetry_; }
  /// Index of an orbit in block c; -1 when the class has no component on it.
  [[nodiscard]] int position(std::size_t c, int orbit) const noexcept {
    return positions_[c][static_cast<std::size_t>(orbit)];
  }
  /// The same of row m's orbit.
  [[nodiscard]] int index(std::size_t c, int m) const noexcept {
    return position(c, places_[static_cast<std::size_t>(m)].orbit);
  }
  [[nodiscard]] double share(std::size_t c, int m) const noexcept;

 private:
  /// Where a row stands among its mirror images.
  struct Place {
    int orbit = 0;    // which set of mirror images
    int element = 0;  // which permutation takes the orbit's first row to this one
  };

  void find_orbits(int rows);
  void find_positions();

  MirrorSymmetry symmetry_;
  std::vector<Place> places_;
  std::vector<Orbit> orbits_;
  std::vector<std::vector<int>> positions_;
  std::vector<int> orders_;
};

}  // namespace compueye::recon
