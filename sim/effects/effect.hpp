#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "sim/effects/circumstances.hpp"
#include "sim/effects/workings.hpp"

namespace compueye::sim {

/// In the order in which light meets them.
enum class EffectGroup { scene, optics, detector, electronics, timing };

[[nodiscard]] std::string_view name(EffectGroup group) noexcept;

/// What an effect does to the samples, for how much of it a reconstruction bears (recon/sensitivity.hpp).
enum class ErrorKind {
  white,        ///< another draw in every channel and frame
  per_channel,  ///< another factor in every channel, the same in every frame
  common_gain,  ///< one factor for all
  offset,       ///< one level for all
  row_shape,    ///< rows of A that see something else: pose, acceptance, depth, motion
};
inline constexpr std::size_t error_kinds = 5;

[[nodiscard]] std::string_view name(ErrorKind kind) noexcept;

/// Seconds on one core, estimated.
struct EffectCost {
  double set_up_s = 0.0;
  double frame_s = 0.0;
};

/// One effect: one file under sim/effects/ and one line in effect_list.cpp. An effect that is off has no part in
/// anything: it was never applied to the workings.
struct Effect {
  std::string_view name;  ///< as scene files and tables call it
  EffectGroup group = EffectGroup::scene;
  std::string_view model;  ///< one line: the formula and its source
  ErrorKind error = ErrorKind::white;
  bool noise = false;  ///< draws anew in every frame: what an exact signal is without
  /// Why this scene before this board calls for it, in a few words with figures; empty: it does not, and leaving it
  /// out changes nothing at all.
  std::string (*calls_for)(const Circumstances&) = nullptr;
  /// Rms over channels and frames of what leaving it out changes, LSB: at least the true value, and where the effect is
  /// the largest at most ten times that. Asked only of an effect that is called for.
  double (*bound)(const Circumstances&) = nullptr;
  EffectCost (*cost)(const Circumstances&) = nullptr;
  /// Takes its part in the workings. Effects are applied in the order of the list.
  void (*apply)(const Circumstances&, Workings&) = nullptr;
  /// The part of the bound that is in the levels which later effects are given. Null: all of it.
  double (*bound_in_levels)(const Circumstances&) = nullptr;
};

/// All of them, in the order of light.
[[nodiscard]] std::span<const Effect* const> effects() noexcept;

/// Error not_found suggests the nearest name.
[[nodiscard]] hal::Result<const Effect*> effect_named(std::string_view name);

}  // namespace compueye::sim
