#include "calib/session/session_plan.hpp"

#include <cmath>
#include <string>

#include "calib/patterns/pattern_family.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

struct Bounds {
  const char* name;
  double value, least, most;
};

}  // namespace

std::int32_t saturated_code(const SessionPlan& plan, int bits) noexcept {
  return static_cast<std::int32_t>(std::ceil(plan.saturation_share * (std::ldexp(1.0, bits) - 1.0)));
}

hal::Result<void> validate(const SessionPlan& p) {
  constexpr double any_count = 1e6;
  const Bounds all[] = {
      {"warm_up_s", p.warm_up_s, 0.0, 86400.0},
      {"dark_frames", static_cast<double>(p.dark_frames), 2.0, any_count},
      {"black_frames", static_cast<double>(p.black_frames), 2.0, any_count},
      {"flat_frames", static_cast<double>(p.flat_frames), 2.0, any_count},
      {"ramp_steps", static_cast<double>(p.ramp_steps), 0.0, 64.0},
      {"ramp_frames", static_cast<double>(p.ramp_frames), 1.0, any_count},
      {"patterns", static_cast<double>(p.patterns), 1.0, any_count},
      {"frames", static_cast<double>(p.frames), 1.0, any_count},
      {"reference_every", static_cast<double>(p.reference_every), 1.0, any_count},
      {"reference_frames", static_cast<double>(p.reference_frames), 1.0, any_count},
      {"dark_every", static_cast<double>(p.dark_every), 1.0, any_count},
      {"held_out_every", static_cast<double>(p.held_out_every), 2.0, any_count},
      {"saturation_share", p.saturation_share, 0.5, 1.0},
      {"least_signal_lsb", p.least_signal_lsb, 1e-3, 1e9},
      {"saturated_channels", p.saturated_channels, 0.0, 1.0},
      {"most_retakes", static_cast<double>(p.most_retakes), 0.0, any_count},
      {"settle_ms", p.settle_ms, 1e-3, 60000.0},
      {"reference_change", p.reference_change, 0.0, 1.0},
  };
  for (const Bounds& b : all) {
    if (b.value >= b.least && b.value <= b.most) continue;
    return hal::fail(
        hal::ErrorCode::out_of_range, std::string("plan.") + b.name,
        "is " + std::to_string(b.value) + ", expected " + std::to_string(b.least) + " to " + std::to_string(b.most));
  }
  TRY(pattern_family(p.family));
  return {};
}

hal::Result<void> check_judged(const SessionPlan& plan) {
  if (plan.patterns >= plan.held_out_every) return {};
  return hal::fail(hal::ErrorCode::out_of_range, "plan.held_out_every",
                   "is " + std::to_string(plan.held_out_every) + " with " + std::to_string(plan.patterns) +
                       " patterns of the family " + plan.family +
                       ", so that none is held out to judge the estimate: expected 2 to the number of patterns");
}

}  // namespace compueye::calib
