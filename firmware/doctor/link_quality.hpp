#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hal/accounting.hpp"
#include "hal/clock.hpp"
#include "hal/counter.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// How frames came in.
struct LinkQuality {
  int frames = 0;
  hal::FrameAccount account;
  std::vector<hal::Counter> counters;  ///< of the source
  double period_ms = 0.0;              ///< that the source states
  /// By how much the time between two frames' exposures is off a whole number of periods, and the same of their arrival
  /// at this program: microseconds, ascending.
  std::vector<double> exposure_jitter_us, arrival_jitter_us;
};

/// The share `part` (0 .. 1) of ascending numbers is at most this; nearest rank. 0 of none.
[[nodiscard]] double percentile(const std::vector<double>& ascending, double part) noexcept;

/// "1 us:  12 ####\n...": how many are below 1, 2, 5, 10, ... microseconds, a line each but where nothing is.
[[nodiscard]] std::string histogram(const std::vector<double>& ascending);

/// Runs the eye for so many frames, within 20 periods and 5 seconds each. Errors: those of the source; interrupted.
[[nodiscard]] hal::Result<LinkQuality> measure_link(hal::SampleSource& eye, hal::Clock& clock, int frames,
                                                    const std::function<bool()>& go_on);

}  // namespace compueye::firmware
