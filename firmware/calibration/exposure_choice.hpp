#pragma once

#include <cstdint>
#include <functional>

#include "calib/session/session_plan.hpp"
#include "hal/clock.hpp"
#include "hal/illuminator.hpp"
#include "hal/result.hpp"
#include "hal/sample_source.hpp"

namespace compueye::firmware {

/// The exposure of an eye that lets it be set while it is stopped.
struct ExposureControl {
  std::int64_t now_ns = 0;    ///< in force
  std::int64_t least_ns = 0;  ///< that the device can do
  std::function<hal::Result<void>(std::int64_t ns)> set;

  /// Sets it, unless it is the one in force.
  [[nodiscard]] hal::Result<void> change(std::int64_t ns);
};

/// Shortens an exposure under which white saturates more channels than the plan allows, until the brightest of the
/// others have a fifth of their range left, or the device can do no less: then the session will refuse the light. It is
/// never made longer than it was. The eye is stopped before and after. Errors: those of the eye and of the light;
/// interrupted.
[[nodiscard]] hal::Result<void> choose_exposure(ExposureControl& exposure, const calib::SessionPlan& plan,
                                                hal::SampleSource& eye, hal::Illuminator& light, hal::Clock& clock,
                                                const std::function<bool()>& go_on);

}  // namespace compueye::firmware
