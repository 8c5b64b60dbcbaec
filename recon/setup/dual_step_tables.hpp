#pragma once

#include <cstdint>
#include <vector>

#include "hal/result.hpp"
#include "recon/core/parts/deflated_step.hpp"
#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// What a core::DeflatedStep<T> looks at.
template <class T>
struct DualStepTables {
  std::vector<std::uint16_t> vectors;
  std::vector<T> gains;
  std::vector<T> rests;
  std::vector<std::int32_t> index;
  std::vector<T> share;
  std::vector<std::int32_t> images;
  core::DeflatedStep<T> view;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return vectors.size() * sizeof(std::uint16_t) + (gains.size() + rests.size() + share.size()) * sizeof(T) +
           (index.size() + images.size()) * sizeof(std::int32_t);
  }
};

/// From leading_modes(): 1 / tau goes through `penalties`, and the modes get 1 - `basis_share` of the bound tau
/// ||Sigma^(1/2) K||^2 <= 1, which holds for the modes as they are stored: with F* = (I + tau A A' / (1 -
/// basis_share))^(-1) it says F <= F*, and F is made smaller by as much as rounding may have added to it. Error
/// out_of_range: the least penalty is so small that rounding could lose a mode, naming how small it may be.
template <class T>
[[nodiscard]] hal::Result<DualStepTables<T>> dual_step_tables(const ParityClasses& classes,
                                                              const std::vector<float>& modes, int rank,
                                                              const std::vector<double>& penalties, double basis_share);

}  // namespace compueye::recon
