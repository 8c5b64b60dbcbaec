#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hal/result.hpp"
#include "sim/effects/circumstances.hpp"

namespace compueye::test {

/// The board of issue 17: the small eye as somebody might have built it, behind a converter of 12 bits.
[[nodiscard]] sim::EyeToSimulate small_built_eye();

/// What a simulated eye gives for each pixel of the object plane by itself at white, found by showing it that pixel.
struct PixelResponses {
  int pixels = 0;
  std::vector<int> ommatidia;  ///< whose rows follow, ascending
  std::vector<double> light;   ///< ommatidia x pixels, after the optics, in fully seen pixels: for Simulation::codes_of
  std::vector<double> signals;  ///< the same after crosstalk and gains: the rows that a calibration is to find

  [[nodiscard]] const double* row(int index) const { return signals.data() + at(index); }
  [[nodiscard]] const double* light_of(int index) const { return light.data() + at(index); }

 private:
  [[nodiscard]] std::size_t at(int m) const { return static_cast<std::size_t>(m) * static_cast<std::size_t>(pixels); }
};

/// The large eye with the same faults, behind the converter of boards/sim-80x80.
[[nodiscard]] sim::EyeToSimulate large_built_eye();

/// Every channel of a board, pixel by pixel: a render of the whole eye for each.
[[nodiscard]] hal::Result<PixelResponses> pixel_responses(const sim::EyeToSimulate& board);

/// Of the named ommatidia (ascending) alone, each rendered by itself; the others give nothing, so that `signals` is
/// right where a channel's four neighbours in the grid are named too.
[[nodiscard]] hal::Result<PixelResponses> pixel_responses_of(const sim::EyeToSimulate& board,
                                                             std::span<const int> ommatidia);

}  // namespace compueye::test
