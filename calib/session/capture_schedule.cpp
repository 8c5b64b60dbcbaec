#include "calib/session/capture_schedule.hpp"

#include <algorithm>

#include "calib/patterns/pattern_family.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

constexpr std::string_view white = "all-on", black = "black", splits = "blobs";

/// Seeds of the ramp's patterns are apart from those of the response's.
constexpr std::uint64_t ramp_seed = 0x72616d70;

Wanted of_stage(Stage stage, std::string_view family, int frames) {
  Wanted wanted;
  wanted.stage = stage;
  wanted.family = family;
  wanted.frames = frames;
  return wanted;
}

void add_ramp(const SessionPlan& plan, std::vector<Wanted>& all) {
  for (int step = 0; step < plan.ramp_steps; ++step) {
    Wanted part = of_stage(Stage::ramp, splits, plan.ramp_frames);
    part.seed = plan.seed ^ ramp_seed;
    part.index = step;
    all.push_back(part);
    all.push_back(of_stage(Stage::ramp_white, white, plan.ramp_frames));
    part.stage = Stage::ramp_rest;
    all.push_back(part);
  }
}

void add_patterns(const SessionPlan& plan, std::int64_t count, std::vector<Wanted>& all) {
  for (std::int64_t k = 0; k < count; ++k) {
    if (k % plan.reference_every == 0) all.push_back(of_stage(Stage::reference, white, plan.reference_frames));
    if (k % plan.dark_every == 0) all.push_back(of_stage(Stage::interleaved_dark, {}, plan.reference_frames));
    const bool held_out = k % plan.held_out_every == plan.held_out_every - 1;
    Wanted pattern = of_stage(held_out ? Stage::held_out : Stage::pattern, plan.family, plan.frames);
    pattern.seed = plan.seed;
    pattern.index = k;
    all.push_back(pattern);
  }
  all.push_back(of_stage(Stage::reference, white, plan.reference_frames));
  all.push_back(of_stage(Stage::interleaved_dark, {}, plan.reference_frames));
}

}  // namespace

std::string_view name(Stage stage) noexcept {
  switch (stage) {
    case Stage::dark:
      return "dark";
    case Stage::black:
      return "black";
    case Stage::flat:
      return "flat";
    case Stage::ramp:
      return "ramp";
    case Stage::ramp_white:
      return "ramp white";
    case Stage::ramp_rest:
      return "ramp rest";
    case Stage::pattern:
      return "pattern";
    case Stage::held_out:
      return "held-out";
    case Stage::reference:
      return "reference";
    case Stage::interleaved_dark:
      return "interleaved dark";
    case Stage::resumed:
      return "resumed";
  }
  return "";
}

std::vector<Wanted> capture_schedule(const SessionPlan& plan, int rows, int cols) {
  std::vector<Wanted> all;
  // Frame by frame: what a channel's codes vary by is told by no sum.
  for (int k = 0; k < plan.dark_frames; ++k) all.push_back(of_stage(Stage::dark, {}, 1));
  for (int k = 0; k < plan.black_frames; ++k) all.push_back(of_stage(Stage::black, black, 1));
  for (int k = 0; k < plan.flat_frames; ++k) all.push_back(of_stage(Stage::flat, white, 1));
  add_ramp(plan, all);
  const auto family = pattern_family(plan.family);
  const std::int64_t there_are = family ? (*family)->count(rows, cols) : 0;
  add_patterns(plan, std::min(plan.patterns, there_are), all);
  return all;
}

bool same_light(const Wanted& a, const Wanted& b) noexcept {
  const bool rest = (a.stage == Stage::ramp_rest) == (b.stage == Stage::ramp_rest);
  return rest && a.family == b.family && a.seed == b.seed && a.index == b.index;
}

hal::Result<hal::Image> picture_of(const Wanted& wanted, int rows, int cols) {
  if (wanted.family.empty()) return hal::Image();
  hal::Image picture = TRY(TRY(pattern_family(wanted.family))->draw(rows, cols, wanted.seed, wanted.index));
  if (wanted.stage == Stage::ramp_rest) {
    for (float& pixel : picture.pixels) pixel = 1.0F - pixel;
  }
  return picture;
}

}  // namespace compueye::calib
