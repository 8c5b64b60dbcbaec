#pragma once

#include <optional>

#include "firmware/app/inspect/figure_list.hpp"
#include "hal/result.hpp"
#include "recon/core/parts/frame_info.hpp"
#include "recon/response.hpp"

namespace compueye::firmware {

/// How A is applied and what one application takes, as `asked` or by rule. Errors: those of recon::operator_figures().
[[nodiscard]] hal::Result<void> add_operator_figures(const recon::Response& response, int image_rows, int image_cols,
                                                     std::optional<recon::OperatorKind> asked, FigureList& figures);

}  // namespace compueye::firmware
