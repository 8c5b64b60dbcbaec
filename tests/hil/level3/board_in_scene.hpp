#pragma once

#include <memory>
#include <string>

#include "firmware/eye/board.hpp"
#include "hal/result.hpp"
#include "sim/simulation.hpp"

namespace compueye::hil {

/// A board's eye in front of a scene, as a simulated one with the seed 0 of its noise sees it: `compueye record` of the
/// same board, of kind "sim", has the same codes.
struct BoardInScene {
  firmware::Board board;
  std::shared_ptr<sim::Simulation> simulation;
};
[[nodiscard]] hal::Result<BoardInScene> board_in_scene(const std::string& folder, const std::string& scene);

}  // namespace compueye::hil
