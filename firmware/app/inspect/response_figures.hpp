#pragma once

#include <optional>

#include "firmware/app/inspect/figure_list.hpp"
#include "firmware/app/option_list.hpp"
#include "hal/result.hpp"
#include "recon/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// What a calibrator wants to know of a matrix before using it. With the picture's `size` also what depends on its rows
/// and columns: mirror symmetry, how A is applied, and the exact memory of admm. Errors: mismatch (size), interrupted.
[[nodiscard]] hal::Result<void> add_response_figures(const recon::Response& a, std::optional<PictureSize> size,
                                                     const recon::Progress& progress, FigureList& figures);

}  // namespace compueye::firmware
