#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "hal/image.hpp"
#include "hal/result.hpp"

namespace compueye::sim {

struct BuiltInScene {
  std::string_view name;
  std::string_view description;  ///< one line for --help
  bool varies = true;            ///< every seed is another picture
};

/// Every picture that needs no file, in the order to list them.
[[nodiscard]] std::span<const BuiltInScene> built_in_scenes() noexcept;

/// Draws one: rows x cols of 1..8192, linear intensities 0..1. The same name, size and seed give the same bits on every
/// platform. Errors: not_found (names the nearest and all known scenes), out_of_range (size).
[[nodiscard]] hal::Result<hal::Image> render_built_in(std::string_view name, int rows, int cols, std::uint64_t seed);

}  // namespace compueye::sim
