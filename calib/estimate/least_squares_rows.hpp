#pragma once

#include <vector>

#include "calib/estimate/estimate.hpp"
#include "calib/estimate/light_samples.hpp"
#include "calib/estimate/shown_patterns.hpp"

namespace compueye::calib {

inline constexpr int least_squares_most_pixels = 4096;

/// Rows by ordinary least squares, every pixel an unknown, from all patterns; sigma is that of the channel's mean
/// noise. Channels that are not good already, or lack a sample, get no entries (the latter: saturated). Entries that
/// noise makes negative stay as they are. Error: unsupported (too many pixels; patterns that do not tell them apart).
[[nodiscard]] hal::Result<std::vector<RowEstimate>> least_squares_rows(const LightSamples& samples,
                                                                       const ShownPatterns& patterns, int pixels);

}  // namespace compueye::calib
