#include "drivers/illuminator/line_light.hpp"

#include <string>
#include <utility>

#include "drivers/illuminator/grey_levels.hpp"
#include "hal/try.hpp"

namespace compueye::illuminator {

hal::Result<std::unique_ptr<LineLight>> LineLight::create(const LineLightSettings& settings,
                                                          std::unique_ptr<hal::OutputLines> lines, hal::Clock& clock) {
  const std::int64_t pixels = std::int64_t{settings.rows} * settings.cols;
  if (lines->count() < 1 || lines->count() != pixels) {
    return hal::fail(hal::ErrorCode::unsupported, lines->name(),
                     "has " + std::to_string(lines->count()) + " lamps, expected " + std::to_string(pixels) +
                         ", one for each pixel of the board's object plane; take a display instead");
  }
  std::unique_ptr<LineLight> light(new LineLight(settings, std::move(lines), clock));
  TRY(light->lines_->open());
  return light;
}

LineLight::LineLight(const LineLightSettings& settings, std::unique_ptr<hal::OutputLines> lines, hal::Clock& clock)
    : lines_(std::move(lines)), clock_(clock), description_{settings.rows, settings.cols, 2, settings.settle_ns} {}

LineLight::~LineLight() {
  // There is nobody to tell of a lamp that stays lit.
  static_cast<void>(lines_->set(0));
  lines_->close();
}

/// A chip that went away and is back wants its lines to be asked for again.
hal::Result<std::int64_t> LineLight::set(std::uint32_t levels) {
  if (!lines_->set(levels)) {
    lines_->close();
    TRY(lines_->open());
    TRY(lines_->set(levels));
  }
  return clock_.now_ns() + description_.settle_ns;
}

hal::Result<std::int64_t> LineLight::show(std::span<const float> intensities) {
  TRY(check_size(description_, intensities, "lamps"));
  std::uint32_t levels = 0;
  for (std::size_t k = 0; k < intensities.size(); ++k) {
    if (level_of(intensities[k], description_.levels) > 0) levels |= std::uint32_t{1} << k;
  }
  return set(levels);
}

hal::Result<std::int64_t> LineLight::off() {
  return set(0);
}

}  // namespace compueye::illuminator
