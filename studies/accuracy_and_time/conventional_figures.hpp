#pragma once

#include <vector>

#include "studies/accuracy_and_time/evaluation_scenes.hpp"
#include "studies/accuracy_and_time/quality_summary.hpp"

namespace compueye::firmware {

/// What the conventional eye makes of the scenes at each noise level; nothing for a lattice that has none. Errors:
/// those of conventional_picture(); interrupted.
[[nodiscard]] hal::Result<std::vector<QualitySummary>> conventional_figures(const Board& board,
                                                                            const std::vector<EvaluationScene>& scenes,
                                                                            const std::vector<NoiseLevel>& levels,
                                                                            const recon::Progress& progress);

}  // namespace compueye::firmware
