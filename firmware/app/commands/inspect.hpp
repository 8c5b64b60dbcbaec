#pragma once

#include <optional>
#include <string>

#include "firmware/app/option_list.hpp"
#include "firmware/eye/board.hpp"
#include "firmware/text/figures.hpp"
#include "hal/result.hpp"
#include "recon/core/frame/frame_info.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// What a board is and what follows from it: the eye, the sensor's LSB and noise, lambda and rho by rule, and the
/// factors kept in the board's .cache. Errors: those of living_response() and lambda_by_rule().
[[nodiscard]] hal::Result<void> add_board_figures(const Board& board, const recon::Progress& progress,
                                                  Figures& figures);

/// What a calibrator wants to know of a matrix before using it. With the picture's `size` also what depends on its rows
/// and columns: mirror symmetry, how A is applied, and the exact memory of admm. Errors: mismatch (size), interrupted.
[[nodiscard]] hal::Result<void> add_response_figures(recon::Response a, std::optional<PictureSize> size,
                                                     const recon::Progress& progress, Figures& figures);

/// What an eye file holds: the eye, its sessions, its estimates with their channels, chi^2, kappas and EMVA 1288
/// figures, and how well the newest one's rows are known. Errors: those of calib::EyeFile.
[[nodiscard]] hal::Result<void> add_eye_file_figures(const std::string& path, Figures& figures);

/// How A is applied and what one application takes, as `asked` or by rule. Errors: those of recon::operator_figures().
[[nodiscard]] hal::Result<void> add_operator_figures(const recon::Response& response,
                                                     std::optional<recon::OperatorKind> asked, Figures& figures);

}  // namespace compueye::firmware
