#pragma once

#include "sim/effects/effect.hpp"

/// Every effect in the order of light: a line each, and a file of that name beside this one. Where two of a group touch
/// the same thing, the later one finds what the earlier one made of it.
#define COMPUEYE_EFFECTS(EFFECT) \
  EFFECT(off_plane)              \
  EFFECT(occlusion)              \
  EFFECT(motion)                 \
  EFFECT(display_response)       \
  EFFECT(pixel_blur)             \
  EFFECT(display_refresh)        \
  EFFECT(light_falloff)          \
  EFFECT(spectral_response)      \
  EFFECT(lamp_drift)             \
  EFFECT(display_drift)          \
  EFFECT(mains_flicker)          \
  EFFECT(misalignment)           \
  EFFECT(acceptance_spread)      \
  EFFECT(refraction)             \
  EFFECT(diffraction)            \
  EFFECT(angular_profile)        \
  EFFECT(coma)                   \
  EFFECT(vignetting)             \
  EFFECT(dust)                   \
  EFFECT(crosstalk)              \
  EFFECT(gain_spread)            \
  EFFECT(temperature)            \
  EFFECT(dark_current)           \
  EFFECT(shot_noise)             \
  EFFECT(full_well)              \
  EFFECT(offset_spread)          \
  EFFECT(defects)                \
  EFFECT(dark_level)             \
  EFFECT(mux_memory)             \
  EFFECT(nonlinearity)           \
  EFFECT(read_noise)             \
  EFFECT(flicker_noise)          \
  EFFECT(sampling_skew)          \
  EFFECT(motion_blur)

namespace compueye::sim::effect {

#define COMPUEYE_DECLARE(name) extern const Effect name;
COMPUEYE_EFFECTS(COMPUEYE_DECLARE)
#undef COMPUEYE_DECLARE

}  // namespace compueye::sim::effect
