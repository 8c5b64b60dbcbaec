#pragma once

#include "hal/result.hpp"
#include "sim/effects/circumstances.hpp"

namespace compueye::sim {

/// A cheap look at the scene: the drawn eye, pictures coarsened to a quarter of what an ommatidium sees
/// of the object plane. Errors: those of Renderer::create.
[[nodiscard]] hal::Result<Preview> preview_of(const EyeToSimulate& board, const Scene& scene);

}  // namespace compueye::sim
