#pragma once

#include <string>
#include <vector>

#include "hal/channel_status.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A figure of every ommatidium where it sits in the grid of the eye, row 0 on top.
struct ChannelMap {
  int rows = 0, columns = 0;
  std::vector<double> values;              ///< rows * columns; NaN: not known; empty: only the channels' states
  std::vector<hal::ChannelStatus> status;  ///< likewise; those that are not good carry a mark
  std::string label;                       ///< of the values, with their unit
};

/// An <svg> of it with axes, the scale of its tones and a legend of the marks. The tones go by decades, since one
/// bad row would hide all others. `id` and `about` as for curve_plot(). Errors: those of tone_picture().
[[nodiscard]] hal::Result<std::string> channel_map(const std::string& id, const std::string& about,
                                                   const ChannelMap& map);

}  // namespace compueye::firmware
