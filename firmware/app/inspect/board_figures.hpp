#pragma once

#include "firmware/app/inspect/figure_list.hpp"
#include "firmware/eye/board.hpp"
#include "hal/result.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// What a board is and what follows from it: the eye, the sensor's LSB and noise, lambda and rho by rule, and the
/// factors kept in the board's .cache. Errors: those of nominal_response() and lambda_by_rule().
[[nodiscard]] hal::Result<void> add_board_figures(const Board& board, const recon::Progress& progress,
                                                  FigureList& figures);

}  // namespace compueye::firmware
