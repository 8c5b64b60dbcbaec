#include "tests/hil/level3/board_in_scene.hpp"

#include <utility>

#include "firmware/eye/scene/scene_choice.hpp"
#include "firmware/eye/simulated_board.hpp"
#include "hal/try.hpp"

namespace compueye::hil {

hal::Result<BoardInScene> board_in_scene(const std::string& folder, const std::string& scene) {
  constexpr std::uint64_t noise = 0;
  BoardInScene made{TRY(firmware::load_board(folder)), nullptr};
  firmware::SceneChoice choice;
  choice.name = scene;
  auto chosen = TRY(firmware::choose_scene(made.board, choice));
  made.simulation = std::make_shared<sim::Simulation>(
      TRY(sim::Simulation::create(firmware::eye_to_simulate(made.board), std::move(chosen), noise)));
  return made;
}

}  // namespace compueye::hil
