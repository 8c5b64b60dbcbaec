#include "firmware/eye/channel_detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace compueye::firmware {

recon::ChannelDetector channel_detector(const Board& board, const ReadyEye& eye) {
  std::vector<std::uint8_t> sees = eye.sees();
  const auto seeing = static_cast<double>(std::count(sees.begin(), sees.end(), 1));
  for (const int dead : board.sensor.dead) sees[static_cast<std::size_t>(dead)] = 0;
  recon::ChannelDetectorSettings settings;
  settings.sigma = fit_sigma(board.noise_sigma(), eye.measured());
  settings.most = static_cast<std::size_t>(std::ceil(board.sensor.max_missing_share * seeing + 1e-9));
  return {board.eye.rows, board.eye.columns, sees, settings};
}

}  // namespace compueye::firmware
