#pragma once

#include <cstddef>

namespace compueye::recon::core {

/// The penalties rho that a frame's iterations go through: `iterations_a_level` with each, the rest with the last.
/// Large at first or small at first is far quicker over the first dozens of iterations than any constant; the end is
/// constant, so that what is said of a constant penalty's convergence holds of it
/// (Boyd et al. 2011, "Distributed optimization and statistical learning via ADMM", section 3.4.1).
template <class T>
struct PenaltySchedule {
  std::size_t levels = 0;  ///< at least 1 where a solver follows one
  std::size_t iterations_a_level = 1;
  const T* penalty = nullptr;  ///< `levels` of them

  /// Of iteration `done`, counted from 0.
  [[nodiscard]] std::size_t level(std::size_t done) const noexcept {
    const std::size_t at = done / iterations_a_level;
    return at < levels ? at : levels - 1;
  }
};

}  // namespace compueye::recon::core
