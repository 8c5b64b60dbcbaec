#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "recon/factor.hpp"
#include "recon/gram_matrix.hpp"
#include "recon/mirror_symmetry.hpp"

namespace compueye::recon {

/// A K0^-1 A' of the seeing rows, taken apart by mirror symmetry: a symmetric eye's matrix is four independent blocks
/// of a quarter the order, one a parity class, and everything that is cubic in the order costs a sixteenth. A measured
/// eye is one block. In double.
///
/// A row of A and its mirror images are an orbit. In class c an orbit has one unit vector, whose entry at its row m is
/// share(c, m); a class without a component on the orbit has none.
class ParityGram {
 public:
  /// `seeing` has no blind rows, lies on an image_rows x image_cols picture and outlives this.
  ParityGram(const Response& seeing, int image_rows, int image_cols, MetricKind metric);

  /// Computes all blocks. Error: interrupted.
  [[nodiscard]] hal::Result<void> fill(const Progress& progress);

  [[nodiscard]] int order() const noexcept { return gram_.order(); }
  [[nodiscard]] std::size_t classes() const noexcept { return blocks_.size(); }
  [[nodiscard]] Eigen::MatrixXd& block(std::size_t c) noexcept { return blocks_[c].matrix; }
  [[nodiscard]] const Eigen::MatrixXd& block(std::size_t c) const noexcept { return blocks_[c].matrix; }

  /// Index in block c of the orbit that row m belongs to; -1 when the class has no component on it.
  [[nodiscard]] int index(std::size_t c, int m) const noexcept {
    return blocks_[c].position[static_cast<std::size_t>(places_[static_cast<std::size_t>(m)].orbit)];
  }
  [[nodiscard]] double share(std::size_t c, int m) const noexcept;

 private:
  /// Where a row of A stands among its mirror images.
  struct Place {
    int orbit = 0;    // which set of mirror images
    int element = 0;  // which permutation takes the orbit's first row to this one
  };
  struct Orbit {
    int first = 0;       // its lowest row
    int stabiliser = 1;  // how many permutations leave that row where it is
    double component = 0.0;
  };
  struct Block {
    std::vector<int> position;  // orbit -> index in the block, -1 when the class has no such component
    Eigen::MatrixXd matrix;
  };

  void find_orbits();
  void find_blocks();
  void fill_row(int p, const std::vector<double>& row);  // of the first row of orbit p

  GramMatrix gram_;
  MirrorSymmetry symmetry_;
  std::vector<Place> places_;
  std::vector<Orbit> orbits_;
  std::vector<Block> blocks_;
};

}  // namespace compueye::recon
