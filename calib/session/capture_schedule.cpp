#include "calib/session/capture_schedule.hpp"

#include <algorithm>

#include "calib/patterns/pattern_family.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

constexpr std::string_view white = "all-on", black = "black", splits = "blobs";

/// Seeds of the ramp's patterns are apart from those of the response's.
constexpr std::uint64_t ramp_seed = 0x72616d70;

void add_ramp(const SessionPlan& plan, std::vector<Wanted>& all) {
  for (int step = 0; step < plan.ramp_steps; ++step) {
    Wanted part{.stage = Stage::ramp, .family = splits, .frames = plan.ramp_frames};
    part.seed = plan.seed ^ ramp_seed;
    part.index = step;
    all.push_back(part);
    all.push_back({.stage = Stage::ramp_white, .family = white, .frames = plan.ramp_frames});
    part.stage = Stage::ramp_rest;
    all.push_back(part);
  }
}

void add_patterns(const SessionPlan& plan, std::string_view family, std::int64_t count, std::vector<Wanted>& all) {
  const Wanted reference{.stage = Stage::reference, .family = white, .frames = plan.reference_frames};
  const Wanted dark{.stage = Stage::interleaved_dark, .family = {}, .frames = plan.reference_frames};
  for (std::int64_t k = 0; k < count; ++k) {
    if (k % plan.reference_every == 0) all.push_back(reference);
    if (k % plan.dark_every == 0) all.push_back(dark);
    const bool held_out = k % plan.held_out_every == plan.held_out_every - 1;
    Wanted pattern{.stage = held_out ? Stage::held_out : Stage::pattern, .family = family, .frames = plan.frames};
    pattern.seed = plan.seed;
    pattern.index = k;
    all.push_back(pattern);
  }
  all.push_back(reference);
  all.push_back(dark);
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
  all.insert(all.end(), static_cast<std::size_t>(plan.dark_frames), {.stage = Stage::dark, .family = {}, .frames = 1});
  all.insert(all.end(), static_cast<std::size_t>(plan.black_frames),
             {.stage = Stage::black, .family = black, .frames = 1});
  all.insert(all.end(), static_cast<std::size_t>(plan.flat_frames),
             {.stage = Stage::flat, .family = white, .frames = 1});
  add_ramp(plan, all);
  // By the list's name and not the plan's, which need not live as long.
  if (const auto family = pattern_family(plan.family)) {
    add_patterns(plan, (*family)->name, std::min(plan.patterns, (*family)->count(rows, cols)), all);
  }
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
