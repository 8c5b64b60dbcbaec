#include "firmware/eye_page/plots/tone_ramp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace compueye::firmware {
namespace {

constexpr std::array<std::array<double, 3>, 4> stops{
    {{239.0, 243.0, 247.0}, {158.0, 196.0, 222.0}, {49.0, 119.0, 181.0}, {8.0, 36.0, 92.0}}};

}  // namespace

Tone tone_of(double share) noexcept {
  if (std::isnan(share)) return {255, 255, 255};
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double part = at - static_cast<double>(below);
  Tone tone{};
  for (std::size_t c = 0; c < tone.size(); ++c) {
    tone[c] = static_cast<std::uint8_t>(std::lround((1.0 - part) * stops[below][c] + part * stops[below + 1][c]));
  }
  return tone;
}

std::string tone_stops() {
  std::string out;
  for (std::size_t s = 0; s < stops.size(); ++s) {
    const double share = static_cast<double>(s) / static_cast<double>(stops.size() - 1);
    const Tone tone = tone_of(share);
    out +=
        fmt::format("<stop offset=\"{:.3f}\" stop-color=\"#{:02x}{:02x}{:02x}\"/>", share, tone[0], tone[1], tone[2]);
  }
  return out;
}

}  // namespace compueye::firmware
