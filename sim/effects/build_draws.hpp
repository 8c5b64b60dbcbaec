#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "hal/build_settings.hpp"
#include "sim/random/random.hpp"

namespace compueye::sim {

/// What decides how ommatidium or channel `m` of this eye came out, for one effect; follows from the build's seed
/// alone.
[[nodiscard]] RandomStream build_draws(const hal::BuildSettings& build, std::string_view effect, int m) noexcept;

/// The first normal draw of each of `count`.
[[nodiscard]] std::vector<double> build_gaussians(const hal::BuildSettings& build, std::string_view effect, int count);

}  // namespace compueye::sim
