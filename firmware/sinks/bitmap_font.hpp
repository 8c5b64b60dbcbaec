#pragma once

#include <array>
#include <cstdint>

namespace compueye::firmware {

/// The 95 printable ASCII characters of the X11 bitmap font "fixed" 10x20 (public domain: "Share and enjoy"). One
/// font of one size for captions is not worth a font library and a font package on every board.
inline constexpr int glyph_cols = 10;
inline constexpr int glyph_rows = 20;
using Glyph = std::array<std::uint16_t, glyph_rows>;  ///< one row each, bit 9 is the leftmost pixel

/// '?' for a character without a glyph.
[[nodiscard]] const Glyph& glyph_for(char character) noexcept;

}  // namespace compueye::firmware
