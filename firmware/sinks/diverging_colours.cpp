#include "firmware/sinks/diverging_colours.hpp"

#include <algorithm>
#include <cmath>

namespace compueye::firmware {
namespace {

constexpr Rgb magenta{255, 0, 255};

struct Stop {
  double at;
  double r, g, b;
};
// Chosen for about the same CIE lightness (20, 50, 65, 92) at each pair of stops.
constexpr std::array<Stop, 5> below{
    {{0.0, 0, 0, 0}, {0.25, 8, 46, 104}, {0.5, 32, 104, 190}, {0.75, 84, 166, 240}, {1.0, 208, 236, 255}}};
constexpr std::array<Stop, 5> above{
    {{0.0, 0, 0, 0}, {0.25, 92, 32, 8}, {0.5, 186, 78, 20}, {0.75, 242, 140, 48}, {1.0, 255, 232, 190}}};

std::uint8_t to_code(double v) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
}

}  // namespace

Rgb diverging_colour(double value) noexcept {
  if (std::isnan(value)) return magenta;
  const auto& stops = value < 0.0 ? below : above;
  const double t = std::min(std::abs(value), 1.0);
  std::size_t i = 1;
  while (i + 1 < stops.size() && stops[i].at < t) ++i;
  const Stop &a = stops[i - 1], &b = stops[i];
  const double f = (t - a.at) / (b.at - a.at);
  return {to_code(a.r + f * (b.r - a.r)), to_code(a.g + f * (b.g - a.g)), to_code(a.b + f * (b.b - a.b))};
}

Rgb grey_colour(double value) noexcept {
  if (std::isnan(value)) return magenta;
  const std::uint8_t code = to_code(255.0 * std::clamp(value, 0.0, 1.0));
  return {code, code, code};
}

}  // namespace compueye::firmware
