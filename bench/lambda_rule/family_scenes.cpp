#include "bench/lambda_rule/family_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sim/pictures/built_in_scenes.hpp"
#include "sim/random/random.hpp"

namespace compueye::bench {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;

/// Waves of up to 24 periods a side, amplitude 1/f, about a mean grey of .5 with a deviation of .2.
hal::Image texture(int rows, int cols, sim::RandomStream& random) {
  constexpr int most = 24;
  std::vector<double> sum(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), 0.0);
  for (int u = 0; u <= std::min(most, cols / 2); ++u) {
    for (int v = -std::min(most, rows / 2); v <= std::min(most, rows / 2); ++v) {
      const double phase = random.uniform(0.0, tau), amplitude = random.gaussian();
      if (u == 0 && v == 0) continue;
      const double size = amplitude / std::hypot(u, v);
      for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < cols; ++c) {
          const auto n = static_cast<std::size_t>(r) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(c);
          sum[n] += size * std::cos(tau * (u * (c + .5) / cols + v * (r + .5) / rows) + phase);
        }
      }
    }
  }
  double squares = 0.0;
  for (const double s : sum) squares += s * s;
  const double scale = .2 / std::sqrt(squares / static_cast<double>(sum.size()));
  hal::Image picture(rows, cols);
  for (std::size_t n = 0; n < sum.size(); ++n) {
    picture.pixels[n] = static_cast<float>(std::clamp(.5 + scale * sum[n], 0.0, 1.0));
  }
  return picture;
}

hal::Image half_plane(int rows, int cols, sim::RandomStream& random) {
  const double angle = random.uniform(0.0, tau), dark = random.uniform(0.0, .3), bright = random.uniform(.6, 1.0);
  const double offset = random.uniform(-.2, .2) * std::min(rows, cols);
  hal::Image picture(rows, cols);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const double along = (c - cols / 2.0 + .5) * std::cos(angle) + (r - rows / 2.0 + .5) * std::sin(angle) - offset;
      const double share = std::clamp(along + .5, 0.0, 1.0);
      picture.pixels[static_cast<std::size_t>(r) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(c)] =
          static_cast<float>(dark + share * (bright - dark));
    }
  }
  return picture;
}

}  // namespace

std::vector<std::string> family_scenes() {
  return {"texture", "half-plane", "line-art", "dots", "fig2"};
}

hal::Image family_picture(const std::string& name, int rows, int cols, std::uint64_t seed) {
  sim::RandomStream random({seed, sim::Draws::picture, 0, 4242});
  if (name == "texture") return texture(rows, cols, random);
  if (name == "half-plane") return half_plane(rows, cols, random);
  return sim::render_built_in(name, rows, cols, seed).value();
}

}  // namespace compueye::bench
