#include "sim/simulated_display.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "hal/try.hpp"

namespace compueye::sim {
namespace {

constexpr std::int64_t refresh_ns = 1'000'000'000 / 60;
constexpr double response_s = 4e-3;
constexpr int levels = 256;

}  // namespace

SimulatedDisplay::SimulatedDisplay(SimulatedEye& eye, hal::Clock& clock) : eye_(eye), clock_(clock) {
  const hal::ObjectPlane& plane = eye.settings().board.object;
  description_ = {plane.rows, plane.cols, levels, 0};
}

hal::Result<std::int64_t> SimulatedDisplay::show(std::span<const float> intensities) {
  hal::Image picture(description_.rows, description_.cols);
  if (intensities.size() != picture.pixels.size()) {
    return hal::fail(hal::ErrorCode::mismatch, "display",
                     "is given " + std::to_string(intensities.size()) + " intensities, expected " +
                         std::to_string(picture.pixels.size()));
  }
  std::transform(intensities.begin(), intensities.end(), picture.pixels.begin(), [](float intensity) {
    constexpr float steps = levels - 1;
    return std::round(std::clamp(intensity, 0.0F, 1.0F) * steps) / steps;
  });
  clock_.sleep_until_ns((clock_.now_ns() / refresh_ns + 1) * refresh_ns);
  TRY(eye_.show(picture, response_s));
  return clock_.now_ns();
}

hal::Result<std::int64_t> SimulatedDisplay::off() {
  TRY(eye_.show({}, response_s));
  return clock_.now_ns();
}

}  // namespace compueye::sim
