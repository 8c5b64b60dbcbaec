#pragma once

#include <array>
#include <cstdint>

namespace compueye::firmware {

using Rgb = std::array<std::uint8_t, 3>;

/// A signed value -1..1 as a colour on black: blue below zero, black at zero, orange above, getting lighter towards
/// both ends. Lightness grows alike on both sides, so that equal errors look equally large; blue and orange stay apart
/// for people with any of the common colour vision deficiencies. Beyond -1..1 the end colours; NaN is magenta.
[[nodiscard]] Rgb diverging_colour(double value) noexcept;

/// A linear intensity as grey, clipped to 0..1; NaN is magenta, so that it is not taken for black.
[[nodiscard]] Rgb grey_colour(double value) noexcept;

}  // namespace compueye::firmware
