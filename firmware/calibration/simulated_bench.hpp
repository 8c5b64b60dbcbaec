#pragma once

#include <cstdint>
#include <memory>

#include "firmware/eye/board.hpp"
#include "hal/clock.hpp"
#include "sim/scene/scene.hpp"
#include "sim/simulated_display.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::firmware {

/// A simulated eye as its board says it was built, before a simulated display, on a clock of their own that runs as
/// fast as they are computed.
struct SimulatedBench {
  std::unique_ptr<hal::VirtualClock> clock;
  std::unique_ptr<sim::SimulatedEye> eye;
  std::unique_ptr<sim::SimulatedDisplay> display;

  /// `scene`: what the display is like and how it stands. Every effect that is called for is simulated, whatever it
  /// costs. Errors: mismatch (the scene is anything but one grey plane that stands still, shines and is as large as the
  /// object plane), and those of SimulatedEye::create().
  [[nodiscard]] static hal::Result<SimulatedBench> create(const Board& board, const sim::Scene& scene,
                                                          std::uint64_t seed);
};

/// A display as a simulated eye is told of it, before it shows anything. Errors: mismatch (as above).
[[nodiscard]] hal::Result<sim::Scene> display_of_patterns(const Board& board, const sim::Scene& scene,
                                                          std::uint64_t seed);

/// A display of the object plane's size, where the board has it, that shows light as it is told.
[[nodiscard]] sim::Scene plain_display(const Board& board);

}  // namespace compueye::firmware
