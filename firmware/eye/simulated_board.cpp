#include "firmware/eye/simulated_board.hpp"

#include <utility>

namespace compueye::firmware {

sim::SimulatedEyeSettings simulated_eye_settings(const Board& board, sim::Scene scene, std::uint64_t seed) {
  sim::SimulatedEyeSettings settings;
  settings.optics.eye = board.eye;
  settings.optics.object = board.object;
  settings.scenes.push_back(std::move(scene));
  settings.sensor = board.sensor;
  settings.seed = seed;
  settings.fifo_frames = board.source.fifo_frames;
  settings.serial = board.source.serial;
  return settings;
}

CorrectionSettings correction_settings(const Board& board, std::span<const std::uint8_t> sees) {
  CorrectionSettings settings;
  settings.dark.assign(static_cast<std::size_t>(board.eye.ommatidia()),
                       static_cast<float>(board.sensor.dark_level_lsb));
  settings.lsb = board.sensor.lsb();
  settings.dead_channels.assign(board.sensor.dead.begin(), board.sensor.dead.end());
  settings.sees.assign(sees.begin(), sees.end());
  settings.saturation_share = board.sensor.saturation_share;
  settings.max_missing_share = board.sensor.max_missing_share;
  return settings;
}

std::optional<Board> conventional_board(const Board& board) {
  if (!(board.eye.interommatidial_rad > 0.0)) return std::nullopt;
  Board narrow = board;
  narrow.eye.acceptance_rad = board.eye.interommatidial_rad;
  narrow.sensor.dead.clear();
  return narrow;
}

}  // namespace compueye::firmware
