#include "sim/effects/build_draws.hpp"

namespace compueye::sim {

RandomStream build_draws(const hal::BuildSettings& build, std::string_view effect, int m) noexcept {
  return RandomStream({build.seed, draws_of(effect), 0, static_cast<std::uint32_t>(m)});
}

std::vector<double> build_gaussians(const hal::BuildSettings& build, std::string_view effect, int count) {
  std::vector<double> draws(static_cast<std::size_t>(count));
  for (int m = 0; m < count; ++m) draws[static_cast<std::size_t>(m)] = build_draws(build, effect, m).gaussian();
  return draws;
}

}  // namespace compueye::sim
