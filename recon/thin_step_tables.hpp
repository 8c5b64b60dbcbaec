#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "recon/core/thin_step.hpp"
#include "recon/parity_classes.hpp"
#include "recon/response.hpp"

namespace compueye::recon {

/// What a core::ThinStep<T> looks at. The products are as if aligned to 64 bytes: `view` starts them there.
template <class T>
struct ThinStepTables {
  std::vector<T> analysis;
  std::vector<T> synthesis;
  std::vector<std::int32_t> pixel;
  std::vector<std::int32_t> image;
  core::ThinStep<T> view;

  [[nodiscard]] std::size_t bytes() const noexcept {
    return (analysis.size() + synthesis.size()) * sizeof(T) + (pixel.size() + image.size()) * sizeof(std::int32_t);
  }
};

/// The thin step of a small eye: empty when pixels are no multiple of 64 or both products would take more than 256 KiB,
/// where the general step is as quick. `inverse` is packed as Factor::values is, in the order of `classes`.
template <class T>
[[nodiscard]] ThinStepTables<T> thin_step_tables(const Response& seeing, int image_rows, int image_cols,
                                                 const ParityClasses& classes, const std::vector<T>& inverse);

}  // namespace compueye::recon
