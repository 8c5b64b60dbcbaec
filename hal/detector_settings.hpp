#pragma once

#include <array>
#include <vector>

#include "hal/result.hpp"

namespace compueye::hal {

/// What photodiodes and converter do besides what SensorSettings says, for a simulation. Every value 0 (or empty): not
/// at all.
struct DetectorSettings {
  double electrons_per_lsb = 0.0;     ///< 1/K of EMVA 1288; 0: light without quanta
  double full_well_e = 0.0;           ///< electrons that a photodiode holds; 0: more than the converter reads
  double flicker_noise_lsb = 0.0;     ///< rms of the 1/f noise over 1000 frames, a channel each
  double dark_current_e_per_s = 0.0;  ///< at 25 degrees C; needs electrons_per_lsb
  double temperature_c = 25.0;        ///< at the start, -40 .. 125; dark current doubles every 8 K
  double warming_c_per_s = 0.0;       ///< -10 .. 10
  double gain_per_c = 0.0;            ///< relative change of every gain a degree from 25, -0.05 .. 0.05
  double inl_lsb = 0.0;      ///< bow of the converter in mid-scale: + 4 inl u (1 - u), u the share of full scale
  int mux_channels = 0;      ///< neighbours that share a converter, read one after the other; 0 or 1: none
  double mux_slot_us = 0.0;  ///< of one channel; > 0 with mux_channels
  double mux_time_constant_us = 0.0;  ///< of the settling from the channel before; 0: settles wholly
  std::array<double, 3> spectral_response{1.0, 1.0, 1.0};  ///< to red, green, blue; >= 0, not all 0
  double integration_ms = 0.0;                             ///< light is gathered so long; 0: the whole frame period
  std::vector<int> hot = {};                               ///< channels with hot_lsb more dark level than told
  double hot_lsb = 0.0;
  std::vector<int> stuck = {};     ///< channels that give the same code for ever, not reported invalid
  std::vector<int> blinking = {};  ///< channels that come and go, a random telegraph of 100 frames

  /// exp(-mux_slot / mux_time_constant): the share of the channel before that is still there. 0 without multiplexer.
  [[nodiscard]] double mux_memory() const noexcept;
  /// Seconds from the first channel of a frame to the last one.
  [[nodiscard]] double scan_s() const noexcept;

  /// Of an eye of `channels`. Error out_of_range or mismatch names the field, its value and what was expected.
  [[nodiscard]] Result<void> validate(int channels) const;
};

}  // namespace compueye::hal
