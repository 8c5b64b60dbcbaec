#include "sim/pictures/built_in_scenes.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "hal/nearest_name.hpp"
#include "sim/pictures/pictures.hpp"

namespace compueye::sim {
namespace {

using hal::ErrorCode;
using hal::fail;

struct Generator {
  BuiltInScene scene;
  hal::Result<hal::Image> (*render)(int rows, int cols, std::uint64_t seed) = nullptr;
};

constexpr std::array<Generator, 9> generators{{
    {{"line-art", "a line drawing, 23 % of the pixels lit (seed 0: a butterfly; others: house, fish, boat, butterfly)"},
     [](int rows, int cols, std::uint64_t seed) -> hal::Result<hal::Image> {
       return pictures::line_art(rows, cols, seed);
     }},
    {{"phantom", "the modified Shepp-Logan head (seed 0: as MATLAB's phantom(n); others: ellipses moved at random)"},
     [](int rows, int cols, std::uint64_t seed) -> hal::Result<hal::Image> {
       return pictures::phantom(rows, cols, seed);
     }},
    {{"bars", "resolution bars of eight widths, upright and lying (1 to 10 pixels at 160x160)"},
     [](int rows, int cols, std::uint64_t seed) -> hal::Result<hal::Image> {
       return pictures::bars(rows, cols, seed);
     }},
    {{"dots", "single bright pixels on black, one in a hundred"},
     [](int rows, int cols, std::uint64_t seed) -> hal::Result<hal::Image> {
       return pictures::dots(rows, cols, seed);
     }},
    {{"fig2", "a face of 19 pixels on 16x16, enlarged by whole factors; the same for every seed", false},
     [](int rows, int cols, std::uint64_t) { return pictures::fig2(rows, cols); }},
    {{"text", "an eye chart of six lines (seed 0: the same letters; others: drawn at random)"},
     [](int rows, int cols, std::uint64_t seed) -> hal::Result<hal::Image> {
       return pictures::text(rows, cols, seed);
     }},
    {{"star", "a Siemens star of 36 spokes; the same for every seed", false},
     [](int rows, int cols, std::uint64_t) -> hal::Result<hal::Image> { return pictures::siemens_star(rows, cols); }},
    {{"slanted-edge",
      "dark and light along an edge 5 degrees off upright, as in ISO 12233 (odd seeds: light on the left)", false},
     [](int rows, int cols, std::uint64_t seed) -> hal::Result<hal::Image> {
       return pictures::slanted_edge(rows, cols, seed);
     }},
    {{"white", "white all over", false},
     [](int rows, int cols, std::uint64_t) -> hal::Result<hal::Image> { return hal::Image(rows, cols, 1.0F); }},
}};

constexpr auto listed = [] {
  std::array<BuiltInScene, generators.size()> scenes{};
  std::size_t i = 0;
  for (const Generator& generator : generators) scenes[i++] = generator.scene;
  return scenes;
}();

tl::unexpected<hal::Error> unknown(std::string_view name) {
  std::vector<std::string_view> names;
  std::string known;
  for (const BuiltInScene& scene : listed) {
    names.push_back(scene.name);
    known += (known.empty() ? "" : ", ") + std::string(scene.name);
  }
  return fail(
      ErrorCode::not_found, "scene",
      "'" + std::string(name) + "' is not a built-in scene, expected one of " + known + hal::did_you_mean(name, names));
}

}  // namespace

std::span<const BuiltInScene> built_in_scenes() noexcept {
  return listed;
}

hal::Result<hal::Image> render_built_in(std::string_view name, int rows, int cols, std::uint64_t seed) {
  const auto found =
      std::find_if(generators.begin(), generators.end(), [&](const Generator& g) { return g.scene.name == name; });
  if (found == generators.end()) return unknown(name);
  if (rows < 1 || cols < 1 || rows > 8192 || cols > 8192) {
    return fail(
        ErrorCode::out_of_range, "scene '" + std::string(name) + "'",
        "asked for " + std::to_string(rows) + "x" + std::to_string(cols) + " pixels, expected 1 to 8192 each way");
  }
  return found->render(rows, cols, seed);
}

}  // namespace compueye::sim
