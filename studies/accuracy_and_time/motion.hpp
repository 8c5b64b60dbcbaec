#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/image.hpp"

namespace compueye::firmware {

/// What the frames before the judged one showed, for solvers that go on from the last frame.
enum class Motion : std::uint8_t {
  none,    ///< nothing: one frame, solved from a cold start
  still,   ///< the same scene, with fresh noise
  sprite,  ///< the same scene but for a piece of it that comes in from the side
};
[[nodiscard]] std::string_view name(Motion motion) noexcept;

/// Frames of a sequence, the judged one last, and how many of them the piece moves in.
inline constexpr std::size_t sequence_frames = 12;
inline constexpr std::size_t moving_frames = 6;

/// The scene so many frames before its piece is in its place: a square a quarter as wide as the picture, from its
/// middle, an eightieth of the width further right for each frame (at least a pixel), and black where it will be.
[[nodiscard]] hal::Image before_arrival(const hal::Image& scene, std::size_t frames);

}  // namespace compueye::firmware
