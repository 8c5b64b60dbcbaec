#pragma once

#include <cstdint>
#include <vector>

#include "firmware/eye/board.hpp"
#include "hal/result.hpp"
#include "recon/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// The nominal response of a board's geometry as far as its ommatidia live.
struct LivingResponse {
  recon::Response response;        ///< the rows of dead ommatidia are empty
  std::vector<std::uint8_t> sees;  ///< by ommatidium, 0 = sees nothing by its geometry; a dead one may well see
};

/// Errors: those of nominal_response(); interrupted.
[[nodiscard]] hal::Result<LivingResponse> living_response(const Board& board, const recon::Progress& progress);

}  // namespace compueye::firmware
