#pragma once

#include <cstdint>
#include <span>

#include "hal/result.hpp"

namespace compueye::hal {

struct IlluminatorDescription {
  int rows = 0;  ///< pixels of the object plane, row 0 on top
  int cols = 0;
  int levels = 2;              ///< distinguishable intensities, 2 = on/off
  std::int64_t settle_ns = 0;  ///< from show() to stable light
};

/// Puts known light in front of the eye during calibration: a display, a projector, a single LED.
class Illuminator {
 public:
  Illuminator() = default;
  Illuminator(const Illuminator&) = delete;
  Illuminator& operator=(const Illuminator&) = delete;
  virtual ~Illuminator() = default;

  [[nodiscard]] virtual const IlluminatorDescription& describe() const noexcept = 0;

  /// Shows rows x cols linear intensities 0..1 (row-major); returns the time after which samples see it whole.
  [[nodiscard]] virtual Result<std::int64_t> show(std::span<const float> intensities) = 0;

  /// To be called between frames: whoever shows a picture for long has to look after it meanwhile. Error disconnected:
  /// the light is gone, or no longer what show() made of it.
  [[nodiscard]] virtual Result<void> attend() { return {}; }

  /// No light at all (lamp off), darker than a black picture.
  [[nodiscard]] virtual Result<std::int64_t> off() = 0;
};

}  // namespace compueye::hal
