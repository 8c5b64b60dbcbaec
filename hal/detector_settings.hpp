#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hal/result.hpp"

namespace compueye::hal {

/// Which of an eye's M channels share a converter, n = mux_channels of them. There are C = M / n converters, rounded
/// up; where M is no multiple of n, some converters have fewer channels.
enum class MuxOrder {
  neighbours,   ///< converter c reads channels c n, c n + 1, .. c n + n - 1, in this order
  interleaved,  ///< converter c reads channels c, c + C, c + 2 C, .., in this order: channel m is converter m mod C's
};

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
  double inl_lsb = 0.0;  ///< bow of the converter in mid-scale: + 4 inl u (1 - u), u the share of full scale
  int mux_channels = 0;  ///< channels that share a converter, read one after the other; 0 or 1: none
  MuxOrder mux_order = MuxOrder::neighbours;  ///< which they are
  double mux_slot_us = 0.0;                   ///< of one channel; > 0 with mux_channels
  double mux_time_constant_us = 0.0;          ///< of the settling from the channel before; 0: settles wholly
  std::array<double, 3> spectral_response{1.0, 1.0, 1.0};  ///< to red, green, blue; >= 0, not all 0
  double integration_ms = 0.0;                             ///< light is gathered so long; 0: the whole frame period
  std::vector<int> hot = {};                               ///< channels with hot_lsb more dark level than told
  double hot_lsb = 0.0;
  std::vector<int> stuck = {};     ///< channels that give the same code for ever, not reported invalid
  std::vector<int> blinking = {};  ///< channels that come and go, a random telegraph of 100 frames

  /// exp(-mux_slot / mux_time_constant): the share of the channel before that is still there. 0 without multiplexer.
  [[nodiscard]] double mux_memory() const noexcept;
  /// Seconds from the first slot of a frame to the last one.
  [[nodiscard]] double scan_s() const noexcept;
  /// Slot of the scan, 0 .. mux_channels - 1, in which `channel` (0 .. channels - 1) of an eye of `channels` is read:
  /// all converters read at once. 0 without multiplexer.
  [[nodiscard]] int slot(int channel, int channels) const noexcept;
  /// The same as a share of scan_s(), 0 .. 1.
  [[nodiscard]] double turn(int channel, int channels) const noexcept;
  /// The channel that the same converter read before it in the same frame; none before the first one.
  [[nodiscard]] std::optional<int> read_before(int channel, int channels) const noexcept;

  /// Of an eye of `channels`. Error out_of_range or mismatch names the field, its value and what was expected.
  [[nodiscard]] Result<void> validate(int channels) const;
};

}  // namespace compueye::hal
