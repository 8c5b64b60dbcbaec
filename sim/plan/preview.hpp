#pragma once

#include "hal/result.hpp"
#include "sim/effects/circumstances.hpp"
#include "sim/render/render_watch.hpp"

namespace compueye::sim {

/// A cheap look at the scene: the drawn eye, pictures coarsened to a quarter of what an ommatidium sees
/// of the object plane. Errors: those of Renderer::create; interrupted (by the watch).
[[nodiscard]] hal::Result<Preview> preview_of(const EyeToSimulate& board, const Scene& scene,
                                              const RenderWatch& watch = {});

}  // namespace compueye::sim
