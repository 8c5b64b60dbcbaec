#pragma once

#include <cstdint>
#include <string>

#include "hal/result.hpp"

namespace compueye::calib {

/// What a calibration session takes, and what it refuses.
struct SessionPlan {
  double warm_up_s = 60.0;       ///< under a white picture before anything counts, 0 .. 86400
  int dark_frames = 64;          ///< with the lamp off, >= 2
  int black_frames = 64;         ///< of a black picture, >= 2; they differ from the dark by the display's black level
  int flat_frames = 64;          ///< of a white picture, >= 2
  int ramp_steps = 8;            ///< splits of the white picture into two parts, 0 .. 64: light adds, codes may not
  int ramp_frames = 16;          ///< of each part, >= 1
  std::string family = "blobs";  ///< of the response patterns
  std::int64_t patterns = 256;   ///< >= 1
  std::uint64_t seed = 1;        ///< of all patterns
  int frames = 1;                ///< averaged for each pattern, >= 1
  int reference_every = 16;      ///< patterns from one white picture to the next, >= 1
  int reference_frames = 4;      ///< >= 1
  int dark_every = 64;           ///< patterns from one look without light to the next, >= 1
  int held_out_every = 5;        ///< each so many-th pattern judges the estimate and has no part in it, >= 2

  double saturation_share = 0.98;   ///< of the largest code, from which a channel is saturated, .5 .. 1
  double least_signal_lsb = 64.0;   ///< of the median channel under white, over the dark, > 0
  double saturated_channels = 0.1;  ///< largest share of the channels that may be saturated under white, 0 .. 1
  int most_retakes = 20;            ///< of one capture before the session gives up, >= 0
  double settle_ms = 500.0;         ///< longest time a new picture may take to be seen whole, > 0
  double reference_change = 0.05;   ///< share of its light that a reference may have changed by at a resume, 0 .. 1
};

/// The least code that counts as saturated.
[[nodiscard]] std::int32_t saturated_code(const SessionPlan& plan, int bits) noexcept;

/// Errors: out_of_range names the setting and its range; not_found: the family, with the nearest.
[[nodiscard]] hal::Result<void> validate(const SessionPlan& plan);
/// That patterns are held out to judge the estimate by. Error: out_of_range.
[[nodiscard]] hal::Result<void> check_judged(const SessionPlan& plan);

}  // namespace compueye::calib
