#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "recon/core/parts/thin_step.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// What a core::ThinStep<T> looks at. The turned rows are as if aligned to 64 bytes: `view` starts them there.
template <class T>
struct ThinStepTables {
  std::vector<T> turned;
  std::vector<T> gains;
  std::vector<T> rotation;
  std::vector<std::int32_t> pixel;
  std::vector<std::int32_t> image;
  core::ThinStep<T> view;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return (turned.size() + gains.size() + rotation.size()) * sizeof(T) +
           (pixel.size() + image.size()) * sizeof(std::int32_t);
  }
};

/// The thin step of a small eye: empty when pixels are no multiple of 64 or A would take more than 128 KiB, where the
/// general step is as quick. rho goes through `penalties`.
template <class T>
[[nodiscard]] ThinStepTables<T> thin_step_tables(const Response& seeing, const ParityClasses& classes,
                                                 const std::vector<double>& penalties);

}  // namespace compueye::recon
