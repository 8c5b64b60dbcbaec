#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/frame_problem.hpp"

namespace compueye::recon::core {

/// A set-up problem, the samples of one frame and the picture that they gave where it was set up: what another
/// processor needs to give the same picture, bit for bit, without a set-up of its own. In its bytes (made by
/// recon/freeze.hpp) numbers take eight bytes and tables start at multiples of 64, little-endian: they can be used
/// where they lie, in a file read to memory or in flash.
struct FrozenFrame {
  FrameProblem<float> problem;
  const float* y = nullptr;        ///< problem.channels
  const float* weights = nullptr;  ///< problem.channels, or null: all one
  const float* picture = nullptr;  ///< problem.pixels()
  double objective = 0.0;          ///< of that picture
};

enum class Thawed : std::uint8_t {
  ready,
  foreign,        ///< does not begin as a frozen frame does
  other_version,  ///< frozen by another version of this program, to be frozen again
  damaged,        ///< cut short, too long, or a table of another size than the problem's numbers say
};

/// Points `frame` into `bytes`, which are aligned to 64 and outlive it.
[[nodiscard]] Thawed thaw(const std::byte* bytes, std::size_t size, FrozenFrame& frame) noexcept;

/// How many of the pixels of x have other bits than frame.picture.
[[nodiscard]] std::size_t differing_pixels(const FrozenFrame& frame, const float* x) noexcept;

}  // namespace compueye::recon::core
