#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "recon/setup/factor.hpp"
#include "recon/setup/gram_matrix.hpp"
#include "recon/setup/parity_classes.hpp"

namespace compueye::recon {

/// A K0^-1 A' of the seeing rows, one block a parity class, so that everything that is cubic in the order costs a
/// sixteenth where the eye is mirror symmetric. In double.
class ParityGram {
 public:
  /// `seeing` has no blind rows and outlives this.
  ParityGram(const Response& seeing, MetricKind metric);

  /// Computes all blocks. Error: interrupted.
  [[nodiscard]] hal::Result<void> fill(const Progress& progress);

  [[nodiscard]] const ParityClasses& classes() const noexcept { return classes_; }
  [[nodiscard]] Eigen::MatrixXd& block(std::size_t c) noexcept { return blocks_[c]; }
  [[nodiscard]] const Eigen::MatrixXd& block(std::size_t c) const noexcept { return blocks_[c]; }

 private:
  void fill_row(int p, const std::vector<double>& row);  // of the first row of orbit p

  GramMatrix gram_;
  ParityClasses classes_;
  std::vector<Eigen::MatrixXd> blocks_;
};

}  // namespace compueye::recon
