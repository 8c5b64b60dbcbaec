#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace compueye::firmware {

using Tone = std::array<std::uint8_t, 3>;

/// 0 (paper) to 1 (dark blue), darker all the way, so that print in grey says the same. Beyond: the ends; NaN: white.
[[nodiscard]] Tone tone_of(double share) noexcept;

/// The stops of a <linearGradient> that goes the same way.
[[nodiscard]] std::string tone_stops();

}  // namespace compueye::firmware
