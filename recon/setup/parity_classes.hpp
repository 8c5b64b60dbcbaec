#pragma once

#include <cstddef>
#include <vector>

#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// The rows of a mirror symmetric A by parity: a matrix over its rows that every flip leaves unchanged is four
/// independent blocks of a quarter the order. A row and its mirror images are an orbit; in class c an orbit has one
/// unit vector, whose entry at its row m is share(c, m), or none at all. A measured eye has one class, with every row
/// an orbit.
class ParityClasses {
 public:
  ParityClasses(int rows, MirrorSymmetry symmetry);

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
