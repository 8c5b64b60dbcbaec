#include "firmware/supervisor/health.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace compueye::firmware {
namespace {

std::int64_t since(std::int64_t now_ns, std::int64_t then_ns) noexcept {
  return std::max<std::int64_t>(now_ns - then_ns, 0);
}

/// No product of numbers of a clock overflows on it.
std::int64_t times(std::int64_t ns, std::int64_t factor) noexcept {
  constexpr std::int64_t longest_ns = 1'000'000'000'000'000;
  return std::min(ns, longest_ns / factor) * factor;
}

std::int64_t piece_limit(const HealthLimits& limits, const StageProgress& stage) noexcept {
  if (stage.ended == 0) return times(limits.stuck_after_ns, 10);
  return std::max(limits.stuck_after_ns, times(stage.longest_ns, 4));
}

struct StageTrouble {
  Trouble trouble = Trouble::none;
  std::optional<Stage> stage;
  std::int64_t for_ns = 0;
};

/// The last stage that is stuck: those before it wait for it, or will.
StageTrouble restart_needed(const HealthLimits& limits, std::int64_t now_ns, const RunCounters& run) noexcept {
  StageTrouble found;
  for (std::size_t i = 0; i < stage_count; ++i) {
    const StageProgress& at = run.stages[i];
    const std::int64_t working_ns = at.working ? since(now_ns, at.since_ns) : 0;
    if (working_ns > piece_limit(limits, at)) found = {Trouble::stuck, static_cast<Stage>(i), working_ns};
  }
  if (found.stage) return found;
  for (std::size_t i = 0; i < stage_count; ++i) {
    const StageProgress& at = run.stages[i];
    if (at.fruitless_from_ns == 0) continue;
    // One that threw something away long ago, and has seen nothing since, is no reason.
    const std::int64_t fruitless_ns = since(at.fruitless_to_ns, at.fruitless_from_ns);
    const bool goes_on = since(now_ns, at.fruitless_to_ns) < limits.fruitless_after_ns;
    if (goes_on && fruitless_ns > limits.fruitless_after_ns) {
      found = {Trouble::fruitless, static_cast<Stage>(i), fruitless_ns};
    }
  }
  return found;
}

/// Which stage keeps the picture waiting, where one is at work for longer than a picture is held for. A source that
/// waits for its eye is no such stage.
StageTrouble slow_stage(std::int64_t held_after_ns, std::int64_t now_ns, const RunCounters& run) noexcept {
  StageTrouble found;
  for (std::size_t i = 1; i < stage_count; ++i) {
    const StageProgress& at = run.stages[i];
    const std::int64_t working_ns = at.working ? since(now_ns, at.since_ns) : 0;
    if (working_ns > held_after_ns) found = {Trouble::slow, static_cast<Stage>(i), working_ns};
  }
  return found;
}

/// Why no picture comes.
StageTrouble why_none(std::int64_t held_after_ns, std::int64_t now_ns, const RunCounters& run) noexcept {
  if (run.recovering) return {Trouble::recovering, {}, 0};
  if (run.checking) return {Trouble::checking, {}, 0};
  if (const StageTrouble slow = slow_stage(held_after_ns, now_ns, run); slow.stage) return slow;
  // The correct stage waits for frames, or turns them down.
  const StageProgress& correct = run.stages[static_cast<std::size_t>(Stage::correct)];
  const bool frames_come = correct.ended > 0 && since(now_ns, correct.since_ns) <= held_after_ns;
  return {frames_come ? Trouble::unusable : Trouble::silent, {}, 0};
}

std::string seconds(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", static_cast<double>(ns) * 1e-9);
  return text;
}

template <class Rows, class Key>
std::string_view name_in(const Rows& rows, Key key) noexcept {
  return rows[static_cast<std::size_t>(key)].name;
}

constexpr bool in_order() {
  for (std::size_t i = 0; i < picture_states.size(); ++i) {
    if (picture_states[i].state != static_cast<PictureState>(i)) return false;
  }
  for (std::size_t i = 0; i < troubles.size(); ++i) {
    if (troubles[i].trouble != static_cast<Trouble>(i)) return false;
  }
  return true;
}
static_assert(in_order(), "rows are found by their number");

}  // namespace

std::string_view name(PictureState state) noexcept {
  return name_in(picture_states, state);
}
std::string_view name(Trouble trouble) noexcept {
  return name_in(troubles, trouble);
}

Health assess(const HealthLimits& limits, std::int64_t now_ns, const RunCounters& run) noexcept {
  Health health;
  health.left_out = run.left_out;
  health.misfit = run.misfit;
  health.picture_ns = since(now_ns, run.published > 0 ? run.published_at_ns : run.begun_ns);
  const std::int64_t held_after_ns = std::max(limits.held_after_ns, times(run.interval_ns, 3));
  const std::int64_t blank_after_ns = std::max({limits.blank_after_ns, held_after_ns, times(run.interval_ns, 10)});
  const bool overdue = health.picture_ns > held_after_ns;
  if (run.published == 0) {
    health.picture = PictureState::starting;
  } else if (overdue) {
    health.picture = health.picture_ns > blank_after_ns ? PictureState::blank : PictureState::held;
  } else if (std::popcount(run.late_bits) >= limits.late_of_32) {
    health.picture = PictureState::late;
    health.trouble = Trouble::deadline;
  } else if (run.left_out > 0 || run.misfit > 0.0) {
    health.picture = PictureState::degraded;
    health.trouble = run.misfit > 0.0 ? Trouble::misfit : Trouble::channels;
  } else {
    health.picture = PictureState::live;
  }
  StageTrouble why = restart_needed(limits, now_ns, run);
  if (why.trouble == Trouble::none && overdue) why = why_none(held_after_ns, now_ns, run);
  if (why.trouble == Trouble::none) return health;
  health.trouble = why.trouble;
  health.stage = why.stage;
  health.trouble_ns = why.for_ns;
  return health;
}

std::string picture_reference() {
  constexpr std::array<std::string_view, 8> words{"emergency", "alert",  "critical", "error",
                                                  "warning",   "notice", "info",     "debug"};
  std::string text = "| picture | what becomes of it | priority |\n|---|---|---|\n";
  for (const PictureStateRow& row : picture_states) {
    text += "| " + std::string(row.name) + " | " + std::string(row.picture) + " | " +
            std::string(words[static_cast<std::size_t>(row.priority)]) + " |\n";
  }
  return text;
}

std::string trouble_reference() {
  std::string text = "| trouble | meaning | restart |\n|---|---|---|\n";
  for (const TroubleRow& row : troubles) {
    if (row.trouble == Trouble::none) continue;
    text +=
        "| " + std::string(row.name) + " | " + std::string(row.meaning) + " | " + (row.restart ? "yes" : "no") + " |\n";
  }
  return text;
}

std::string Health::sentence() const {
  std::string text = "picture " + std::string(name(picture));
  const bool is_old = picture == PictureState::held || picture == PictureState::blank;
  if (is_old) text += ", the last one came " + seconds(picture_ns) + " ago";
  if (trouble == Trouble::none) return text;
  const std::string_view meaning = troubles[static_cast<std::size_t>(trouble)].meaning;
  text += ": ";
  if (stage) {
    return text + std::string(name(*stage)) + " is " + std::string(name(trouble)) + " for " + seconds(trouble_ns) +
           " (" + std::string(meaning) + ")";
  }
  text += meaning;
  if (trouble == Trouble::channels) text += " (" + std::to_string(left_out) + ")";
  if (trouble == Trouble::misfit) text += " (" + std::to_string(std::llround(misfit)) + " times the noise)";
  return text;
}

}  // namespace compueye::firmware
