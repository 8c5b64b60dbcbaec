#include "calib/session/session_machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calib/median.hpp"
#include "hal/try.hpp"

namespace compueye::calib {
namespace {

using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr int level_frames = 16;

double mean_code(const hal::SampleBlock& block) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t c = 0; c < block.codes.size(); ++c) {
    if (block.valid[c] == 0) continue;
    sum += block.codes[c];
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

/// Of the channels that are valid in both.
std::vector<double> difference(const Capture& light, const Capture& dark) {
  std::vector<double> all;
  for (std::size_t c = 0; c < light.codes.size(); ++c) {
    if (light.valid[c] == 0 || dark.valid[c] == 0) continue;
    all.push_back(static_cast<double>(light.codes[c]) / light.frames -
                  static_cast<double>(dark.codes[c]) / dark.frames);
  }
  return all;
}

std::string rounded(double value) {
  return std::to_string(std::llround(value));
}

std::int32_t largest_code(int bits) {
  return (std::int32_t{1} << bits) - 1;
}

}  // namespace

Result<SessionMachine> SessionMachine::create(const SessionPlan& plan, const SessionEye& eye, int rows, int cols,
                                              const Resumed& resumed, std::int64_t now_ns) {
  TRY(validate(plan));
  TRY(check_judged(plan));
  return create(plan, eye, capture_schedule(plan, rows, cols), resumed, now_ns);
}

Result<SessionMachine> SessionMachine::create(const SessionPlan& plan, const SessionEye& eye,
                                              std::vector<Wanted> schedule, const Resumed& resumed,
                                              std::int64_t now_ns) {
  TRY(validate(plan));
  if (eye.channels < 1 || eye.bits < 1 || eye.bits > 24) {
    return fail(ErrorCode::out_of_range, "eye",
                "has " + std::to_string(eye.channels) + " channels of " + std::to_string(eye.bits) +
                    " bits, expected at least one, of 1 to 24 bits");
  }
  int most = level_frames;
  for (const Wanted& each : schedule) most = std::max(most, each.frames);
  const std::int64_t hold = std::numeric_limits<std::int32_t>::max() / (largest_code(eye.bits) + 1);
  if (most > hold) {
    return fail(ErrorCode::out_of_range, "plan",
                "averages " + std::to_string(most) + " frames in a capture, expected at most " + std::to_string(hold) +
                    " of " + std::to_string(eye.bits) + " bits: take more patterns instead");
  }
  return SessionMachine(plan, eye, std::move(schedule), resumed, now_ns);
}

SessionMachine::SessionMachine(const SessionPlan& plan, const SessionEye& eye, std::vector<Wanted> schedule,
                               const Resumed& resumed, std::int64_t now_ns)
    : plan_(plan),
      eye_(eye),
      schedule_(std::move(schedule)),
      resumed_(resumed),
      builder_(eye.channels, eye.configuration, saturated_code(plan, eye.bits),
               static_cast<int>(plan.saturated_channels * eye.channels)),
      warm_ns_(now_ns + static_cast<std::int64_t>(plan.warm_up_s * 1e9)),
      position_(resumed.captures) {
  begin(Phase::warm_up);
}

void SessionMachine::want(const Wanted& wanted) {
  wanted_ = wanted;
  need_ = Need::light;
  builder_.begin(wanted, phase_ == Phase::level_dark || phase_ == Phase::level_white);
}

void SessionMachine::begin(Phase phase) {
  phase_ = phase;
  switch (phase) {
    case Phase::warm_up:
    case Phase::rising:
      return want({.stage = Stage::flat, .family = "all-on", .frames = 1});
    case Phase::falling:
      return want({.stage = Stage::black, .family = "black", .frames = 1});
    case Phase::level_dark:
      return want({.stage = Stage::dark, .family = {}, .frames = level_frames});
    case Phase::level_white:
      return want({.stage = Stage::flat, .family = "all-on", .frames = level_frames});
    case Phase::resume:
      return want({.stage = Stage::resumed, .family = "all-on", .frames = plan_.reference_frames});
    case Phase::captures:
      return;
  }
}

void SessionMachine::want_capture(std::int64_t now_ns) {
  if (phase_ != Phase::captures) captures_began_ns_ = now_ns;
  begin(Phase::captures);
  if (position_ >= static_cast<std::int64_t>(schedule_.size())) {
    need_ = Need::nothing;
    return;
  }
  want(schedule_[static_cast<std::size_t>(position_)]);
}

void SessionMachine::lit(std::int64_t now_ns, std::int64_t stable_ns) noexcept {
  lit_ns_ = now_ns;
  stable_ns_ = stable_ns;
  passed_over_ = 0;
  need_ = Need::frame;
  watch_.emplace(now_ns, std::max<std::int64_t>(static_cast<std::int64_t>(plan_.settle_ms * 1e6), stable_ns - now_ns));
}

Result<void> SessionMachine::saw_settling(std::int64_t begun_ns, const hal::SampleBlock& block) {
  watch_->add(begun_ns, mean_code(block));
  if (!watch_->complete()) return {};
  const auto settled = watch_->settled_after_ns();
  if (!settled) {
    return fail(ErrorCode::out_of_range, "light",
                "does not settle within " + rounded(plan_.settle_ms) +
                    " ms of a change: wait until it is warm, keep other lamps away, or allow more with settle_ms");
  }
  // Where light comes exponentially, three times the time makes a hundredth a millionth.
  settle_ns_ = std::max(settle_ns_, 3 * *settled);
  begin(phase_ == Phase::falling ? Phase::rising : Phase::level_dark);
  return {};
}

std::vector<double> SessionMachine::signal() const {
  return difference(white_, dark_);
}

Result<void> SessionMachine::check_level() const {
  const double full = largest_code(eye_.bits), end = saturated_code(plan_, eye_.bits);
  int saturated = 0;
  for (std::size_t c = 0; c < white_.codes.size(); ++c) {
    saturated += white_.valid[c] != 0 && static_cast<double>(white_.codes[c]) / white_.frames >= end ? 1 : 0;
  }
  if (saturated > static_cast<int>(plan_.saturated_channels * eye_.channels)) {
    return fail(ErrorCode::out_of_range, "light",
                "saturates " + std::to_string(saturated) + " of " + std::to_string(eye_.channels) +
                    " channels under white: dim the display or shorten the integration, or allow more with "
                    "saturated_channels");
  }
  const double level = median(signal());
  if (level >= plan_.least_signal_lsb) return {};
  return fail(ErrorCode::out_of_range, "light",
              "gives the median channel " + rounded(level) + " LSB of " + rounded(full) +
                  " under white, expected at least " + rounded(plan_.least_signal_lsb) +
                  ": is the display on and before the eye? Else brighten it or lengthen the integration");
}

Result<void> SessionMachine::check_reference() const {
  if (!resumed_.reference) return {};
  std::vector<double> now = difference(builder_.capture(), dark_), before = difference(*resumed_.reference, dark_);
  if (now.size() != before.size() || now.empty()) {
    return fail(ErrorCode::mismatch, "reference",
                "has other valid channels than before the interruption: is it the same eye? Begin a new session");
  }
  double sum_now = 0.0, whole = 0.0;
  for (std::size_t c = 0; c < now.size(); ++c) {
    sum_now += std::fabs(now[c]);
    whole += std::fabs(before[c]);
  }
  double changed = 0.0, apart = 0.0;
  for (std::size_t c = 0; c < now.size(); ++c) {
    changed += std::fabs(now[c] - before[c]) / std::max(whole, 1.0);
    apart += std::fabs(now[c] / std::max(sum_now, 1.0) - before[c] / std::max(whole, 1.0));
  }
  // A lamp moves all channels together; an eye that was touched does not.
  constexpr double apart_share = 0.2;
  if (changed <= plan_.reference_change && apart <= apart_share * plan_.reference_change) return {};
  const bool alike = apart <= apart_share * plan_.reference_change;
  const auto percent = [](double share) { return std::to_string(0.1 * std::round(1000.0 * share)).substr(0, 4); };
  return fail(ErrorCode::mismatch, "reference",
              "has changed by " + percent(alike ? changed : apart) + " %" +
                  (alike ? "" : ", not in all channels alike,") + " since before the interruption, expected at most " +
                  percent((alike ? 1.0 : apart_share) * plan_.reference_change) +
                  " %: put eye, display and light back as they were, or begin a new session by --give-up");
}

Result<void> SessionMachine::taken_too_often() const {
  const Rejection why = builder_.last_rejection();
  const std::string begun = "capture " + std::to_string(position_) + " was taken again " +
                            std::to_string(builder_.retakes()) + " times (" + std::string(name(why)) + "): ";
  const std::string place(name(wanted_.stage));
  switch (why) {
    case Rejection::saturated:
      return fail(ErrorCode::out_of_range, place, begun + "dim the light or shorten the integration");
    case Rejection::configuration:
      return fail(ErrorCode::mismatch, place, begun + "its settings changed meanwhile: leave it alone, and resume");
    case Rejection::gap:
    case Rejection::overrun:
    case Rejection::recovered:
      return fail(ErrorCode::io, place, begun + "see to the cable and the load of this machine, and resume");
  }
  return {};
}

Result<void> SessionMachine::saw_capture(const hal::SampleBlock& block, std::int64_t now_ns) {
  if (!builder_.add(block)) {
    if (builder_.retakes() <= plan_.most_retakes) return {};
    return taken_too_often();
  }
  switch (phase_) {
    case Phase::level_dark:
      dark_ = builder_.capture();
      begin(Phase::level_white);
      return {};
    case Phase::level_white:
      white_ = builder_.capture();
      signal_lsb_ = median(signal());
      TRY(check_level());
      if (resumed_.captures > 0) {
        begin(Phase::resume);
      } else {
        want_capture(now_ns);
      }
      return {};
    case Phase::resume:
      TRY(check_reference());
      want_capture(now_ns);
      return {};
    default:
      need_ = Need::commit;
      return {};
  }
}

/// Frames of before are read within a moment, unless the two clocks part so fast that every frame seems to be one.
Result<void> SessionMachine::pass_over(std::int64_t waited_ns) {
  constexpr std::int64_t moment_ns = 10'000'000'000;
  constexpr int most_at_hand = 100;
  if (++passed_over_ < most_at_hand || waited_ns < moment_ns) return {};
  return fail(ErrorCode::mismatch, "device time",
              "falls behind this machine's so fast that frames cannot be told from those before a change of light: see "
              "to the clock of the eye's firmware");
}

Result<void> SessionMachine::saw(const hal::SampleBlock& block, std::int64_t now_ns) {
  const std::int64_t begun_ns = frame_time_.begun_ns(block.t_ns, block.flags.time_ok, now_ns);
  if (phase_ == Phase::warm_up) {
    if (now_ns >= warm_ns_) begin(Phase::falling);
    return {};
  }
  if (phase_ == Phase::falling || phase_ == Phase::rising) return saw_settling(begun_ns, block);
  const std::int64_t settled_ns = std::max(stable_ns_, lit_ns_ + settle_ns_);
  if (begun_ns < settled_ns) return pass_over(now_ns - settled_ns);
  return saw_capture(block, now_ns);
}

void SessionMachine::committed(std::int64_t now_ns) noexcept {
  ++position_;
  if (position_ < static_cast<std::int64_t>(schedule_.size()) &&
      same_light(schedule_[static_cast<std::size_t>(position_)], wanted_)) {
    wanted_ = schedule_[static_cast<std::size_t>(position_)];
    builder_.begin(wanted_);
    need_ = Need::frame;
    return;
  }
  want_capture(now_ns);
}

Result<void> SessionMachine::recovered(std::int64_t now_ns) {
  if (need_ == Need::commit || need_ == Need::nothing) return {};  // what was taken is taken
  if (phase_ == Phase::warm_up || phase_ == Phase::falling || phase_ == Phase::rising) {
    // A change of light that was not seen tells no time, so that both are made again, from a white that has settled.
    warm_ns_ = std::max(warm_ns_, now_ns + static_cast<std::int64_t>(plan_.settle_ms * 1e6));
    begin(Phase::warm_up);
    return {};
  }
  builder_.recovered();
  need_ = Need::light;
  return builder_.retakes() <= plan_.most_retakes ? Result<void>() : taken_too_often();
}

SessionProgress SessionMachine::progress(std::int64_t now_ns) const {
  SessionProgress p;
  p.stage = phase_ == Phase::captures  ? name(wanted_.stage)
            : phase_ == Phase::warm_up ? "warm-up"
                                       : "looking at the light";
  p.taken = position_;
  p.of = static_cast<std::int64_t>(schedule_.size());
  for (std::size_t k = 0; k < rejections; ++k) p.rejected[k] = builder_.rejected(static_cast<Rejection>(k));
  p.signal_lsb = signal_lsb_;
  p.settle_ms = static_cast<double>(settle_ns_) * 1e-6;
  const std::int64_t here = position_ - resumed_.captures;
  if (phase_ == Phase::captures && here > 0) {
    p.seconds_left = static_cast<double>(now_ns - captures_began_ns_) * 1e-9 / static_cast<double>(here) *
                     static_cast<double>(p.of - p.taken);
  }
  return p;
}

}  // namespace compueye::calib
