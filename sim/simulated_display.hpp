#pragma once

#include "hal/clock.hpp"
#include "hal/illuminator.hpp"
#include "sim/simulated_eye.hpp"

namespace compueye::sim {

/// A display before a simulated eye: the first surface of its scene, which takes the pictures of a calibration. What
/// the scene says of displays (gamma, black level, drift, blurred pixels) happens to them; intensities are rounded to
/// 256 levels, and a new picture comes after a refresh of 60 Hz and with a time constant of 4 ms, though the display
/// believes that it is there at once: how long it takes is a calibration's to find out.
class SimulatedDisplay final : public hal::Illuminator {
 public:
  /// Both must outlive it. What it covered is seen again when it is gone.
  SimulatedDisplay(SimulatedEye& eye, hal::Clock& clock);
  ~SimulatedDisplay() override { eye_.uncover(); }

  [[nodiscard]] const hal::IlluminatorDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] hal::Result<std::int64_t> show(std::span<const float> intensities) override;
  [[nodiscard]] hal::Result<std::int64_t> off() override;

 private:
  SimulatedEye& eye_;
  hal::Clock& clock_;
  hal::IlluminatorDescription description_;
};

}  // namespace compueye::sim
