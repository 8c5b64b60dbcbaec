#pragma once

#include <vector>

#include "firmware/eye/ready_eye.hpp"
#include "hal/result.hpp"
#include "studies/accuracy_and_time/evaluation_scenes.hpp"
#include "studies/accuracy_and_time/sweep_table.hpp"

namespace compueye::firmware {

/// The board as it would be if its file named this curve.
[[nodiscard]] Board with_curve(const Board& board, const Curve& curve);

/// One curve set up for every noise level, its factor made once and kept beside the board.
struct CurveEyes {
  std::vector<recon::Reconstructor> by_level;
  std::vector<double> lambda;  ///< by rule
  std::vector<std::string> notes;
};

/// Errors: those of ReadyEye::make().
[[nodiscard]] hal::Result<CurveEyes> set_up_curve(const Board& board, const LivingResponse& living, const Curve& curve,
                                                  const std::vector<NoiseLevel>& levels,
                                                  const recon::Progress& progress);

}  // namespace compueye::firmware
