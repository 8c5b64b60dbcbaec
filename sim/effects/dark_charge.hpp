#pragma once

#include "sim/effects/circumstances.hpp"

namespace compueye::sim {

/// Mean dark level that one frame's dark current makes at a temperature, LSB; doubles every 8 K. 0 without electrons.
[[nodiscard]] double dark_charge_lsb(const EyeToSimulate& board, double celsius) noexcept;

/// Of the sensor at `t_s` after frame 0; stays within -40 .. 125 degrees C.
[[nodiscard]] double temperature_c(const hal::DetectorSettings& detector, double t_s) noexcept;

/// At the end of the hour, or of a longer scene, that bounds look at.
[[nodiscard]] double end_temperature_c(const Circumstances& c) noexcept;

/// Of the warmest frame in that time.
[[nodiscard]] double largest_dark_charge_lsb(const Circumstances& c) noexcept;

/// What a frame's level gathers at most, LSB, dark current included: preview times what light, gains, drifts and
/// warming may add.
[[nodiscard]] double largest_level_lsb(const Circumstances& c, double level_lsb) noexcept;

}  // namespace compueye::sim
