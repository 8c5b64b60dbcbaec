#pragma once

#include <vector>

#include "firmware/eye/ready_eye.hpp"
#include "firmware/operating_points/point_choice.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// The points of a choice, ready to be solved with: an eye for every curve among them and, for each rung, which eye it
/// is and with how many iterations. Points of one curve share its eye.
struct PointLadder {
  struct Rung {
    std::size_t eye = 0;
    recon::OperatingPoint point;
  };
  std::vector<ReadyEye> eyes;  ///< the first is the chosen point's
  std::vector<Rung> rungs;
};

/// `request` says sigma and cache. Errors: those of ReadyEye::make().
[[nodiscard]] hal::Result<PointLadder> make_ladder(const Board& board, const LivingResponse& living, const Sweep& sweep,
                                                   const PointChoice& choice, const EyeRequest& request,
                                                   const recon::Progress& progress);

}  // namespace compueye::firmware
