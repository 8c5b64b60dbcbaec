#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "calib/session/session_plan.hpp"
#include "hal/image.hpp"

namespace compueye::calib {

/// The parts of a session, in the order in which they begin. References, darks and held-out patterns come between the
/// patterns.
enum class Stage {
  dark,
  black,
  flat,
  ramp,
  ramp_white,
  ramp_rest,
  pattern,
  held_out,
  reference,
  interleaved_dark,
  resumed
};

inline constexpr std::array all_stages{
    Stage::dark,      Stage::black,   Stage::flat,     Stage::ramp,      Stage::ramp_white,
    Stage::ramp_rest, Stage::pattern, Stage::held_out, Stage::reference, Stage::interleaved_dark,
    Stage::resumed};

[[nodiscard]] std::string_view name(Stage stage) noexcept;

/// One thing to be captured.
struct Wanted {
  Stage stage = Stage::dark;
  std::string_view family = {};  ///< of pattern_families(); empty: no light
  std::uint64_t seed = 0;
  std::int64_t index = 0;  ///< of ramp_rest: white less this pattern is shown
  int frames = 1;          ///< summed
};

/// Whether one picture serves both.
[[nodiscard]] bool same_light(const Wanted& a, const Wanted& b) noexcept;

/// What a session captures, from the first to the last: number k is the session's capture k, whatever happened
/// meanwhile, so that a session goes on where it was cut off. Every stretch of patterns begins and ends with a
/// reference, so that none is beyond the last one. The family has as many patterns as the plan asks, or fewer patterns
/// are taken.
[[nodiscard]] std::vector<Wanted> capture_schedule(const SessionPlan& plan, int rows, int cols);

/// What is shown for it; an empty image for no light. Errors: those of PatternFamily::draw().
[[nodiscard]] hal::Result<hal::Image> picture_of(const Wanted& wanted, int rows, int cols);

}  // namespace compueye::calib
