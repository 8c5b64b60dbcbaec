#pragma once

#include <string>

#include "sim/effects/effect.hpp"

namespace compueye::sim {

/// What bounds allow for the preview's few per cent and for what other effects do to the levels.
inline constexpr double margin = 1.25;

/// "0.25", "1.2e+03": three digits, for a reason in words.
[[nodiscard]] std::string figure(double value);

/// Of a surface with its turning, at its farthest corner: mm/s. And of the fastest of the scene.
[[nodiscard]] double speed_mm_per_s(const Surface& surface) noexcept;
[[nodiscard]] double speed_mm_per_s(const Circumstances& c) noexcept;

/// Change of the levels for a way in any direction, rms over the channels, LSB by mm: sqrt 2 of the preview's, whose
/// two directions may both be as steep.
[[nodiscard]] double steepness_lsb_per_mm(const Circumstances& c) noexcept;

/// Of what a look at several times found: twice that, since it looked at other times than a frame does.
[[nodiscard]] double looked_bound(double change_lsb) noexcept;

/// From an apex to the object plane, about.
[[nodiscard]] double range_mm(const Circumstances& c) noexcept;

/// Radius of what an ommatidium sees of the object plane when it looks straight at it.
[[nodiscard]] double look_radius_mm(const Circumstances& c) noexcept;

/// What an ommatidium delivers that looks straight at white, LSB.
[[nodiscard]] double white_lsb(const Circumstances& c) noexcept;

/// Brightest pixel of the scene, as lit.
[[nodiscard]] double brightest(const Circumstances& c) noexcept;

/// Of a step of `ns` nanoseconds a channel.
[[nodiscard]] EffectCost step_cost(const Circumstances& c, double ns) noexcept;

/// Of rendering the whole scene `renders` times more a frame.
[[nodiscard]] EffectCost render_cost(const Circumstances& c, double renders) noexcept;

/// The same where what is rendered does not change unless something moves.
[[nodiscard]] EffectCost render_once_cost(const Circumstances& c, double renders) noexcept;

}  // namespace compueye::sim
