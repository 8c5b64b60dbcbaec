#pragma once

#include "hal/channel_status.hpp"

namespace compueye::calib {

using hal::ChannelStatus;

/// When a channel's row is masked.
struct StatusLimits {
  double dead_share = 0.05;          ///< of the channels' median response, each over what the drawing expects of it
  double hot_deviations = 6.0;       ///< median absolute deviations of the dark level above its median
  double least_deviation_lsb = 1.0;  ///< that those are taken for at least
  double noisy_ratio = 4.0;          ///< variance over the model's
  double saturated_share = 0.05;     ///< of a channel's captures
  double misfit_share = 0.15;        ///< rms misfit over the spread of the signal, both over the patterns held out,
  double misfit_chi2 = 4.0;          ///< and chi^2 a point: beyond both, a channel does not fit
  double blind_pixels = 0.5;         ///< drawn to see less than so many pixels: blind
};

}  // namespace compueye::calib
