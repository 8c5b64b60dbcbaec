#include "firmware/calibration/checked_source.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "hal/image.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

using calib::Need;
using hal::ErrorCode;
using hal::fail;
using hal::Result;

constexpr std::int64_t between_tries_ns = 100'000'000;
constexpr int most_tries = 50;

}  // namespace

CheckedSource::CheckedSource(CheckSettings settings, hal::SampleSource& source, hal::Clock& clock)
    : settings_(std::move(settings)),
      source_(source),
      clock_(clock),
      order_(source.describe()),
      period_ns_(source.describe().frame_rate_hz > 0.0
                     ? static_cast<std::int64_t>(1e9 / source.describe().frame_rate_hz)
                     : std::int64_t{0}) {
  // How long light takes is told by white that has settled.
  settings_.plan.warm_up_s = std::max(settings_.plan.warm_up_s, 1e-3 * settings_.plan.settle_ms);
}

Result<void> CheckedSource::do_start() {
  frame_time_ = {};
  last_ns_ = std::numeric_limits<std::int64_t>::max();
  scene_from_ns_ = std::numeric_limits<std::int64_t>::min();
  passed_ns_ = 0;
  outages_ = delivered_ = 0;
  due_ = withheld_ = checking_ = again_ = false;
  checked_ = 0;
  booked_ = of_checks_ = {};
  was_of_check_ = false;
  return source_.start();
}

Result<hal::SampleBlock> CheckedSource::do_read(std::int64_t deadline_ns) {
  withheld_ = std::exchange(due_, false);
  if (withheld_) begin();
  for (;;) {
    auto block = source_.read(deadline_ns);
    if (!block) return block;
    const std::int64_t now_ns = clock_.now_ns();
    const std::int64_t begun_ns = frame_time_.begun_ns(block->t_ns, block->flags.time_ok, now_ns);
    const bool of_scene = is_of_scene(*block, begun_ns);
    book(!of_scene);
    if (of_scene) {
      ++delivered_;
      checking_ = false;
      return block;
    }
    withheld_ = true;
    ++checked_;
    if (machine_) {
      if (auto looked = look(*block); !looked) end(tl::unexpected(std::move(looked.error())));
    } else if (light_ != nullptr && now_ns - tried_ns_ >= between_tries_ns) {
      TRY(put_out(now_ns));
    }
    if (clock_.now_ns() >= deadline_ns) return hal::timed_out();
  }
}

/// What was lost from its beginning to its last frame is the check's, as its frames are.
void CheckedSource::book(bool of_check) noexcept {
  const hal::FrameAccount now = source_.account();
  if (of_check && was_of_check_) {
    checked_ += now.total_dropped() - booked_.total_dropped();
    for (std::size_t k = 0; k < now.dropped.size(); ++k) of_checks_.dropped[k] += now.dropped[k] - booked_.dropped[k];
    of_checks_.estimated += now.estimated - booked_.estimated;
  }
  booked_ = now;
  was_of_check_ = of_check;
}

bool CheckedSource::is_of_scene(const hal::SampleBlock& block, std::int64_t begun_ns) noexcept {
  config_id_ = block.config_id;
  if (machine_ || light_ != nullptr || begun_ns < scene_from_ns_) {
    last_ns_ = block.t_ns;
    return false;
  }
  pass_time(block);
  return true;
}

/// A device that began anew has no time since the last frame.
void CheckedSource::pass_time(const hal::SampleBlock& block) noexcept {
  if (!block.flags.time_ok) {
    passed_ns_ += period_ns_;
  } else if (block.t_ns > last_ns_) {
    passed_ns_ += block.t_ns - last_ns_;
  }
  last_ns_ = block.t_ns;
  due_ = again_ || passed_ns_ >= settings_.every_ns;
}

void CheckedSource::begin() {
  checking_ = true;
  was_of_check_ = true;  // its first picture takes its time, too
  again_ = false;
  const hal::SourceDescription& eye = source_.describe();
  passed_ns_ = 0;
  tries_ = 0;
  settle_ns_ = 0;
  taken_.clear();
  outages_ = source_.outages();
  auto begun = [&]() -> Result<void> {
    light_ = TRY(settings_.light());
    machine_ = TRY(calib::SessionMachine::create(settings_.plan, {eye.channels, eye.bits, config_id_},
                                                 settings_.schedule, {}, clock_.now_ns()));
    return serve();
  }();
  if (!begun) end(tl::unexpected(std::move(begun.error())));
}

Result<void> CheckedSource::look(const hal::SampleBlock& block) {
  TRY(light_->attend());
  const std::uint64_t outages = source_.outages();
  const std::int64_t now_ns = clock_.now_ns();
  TRY(std::exchange(outages_, outages) != outages ? machine_->recovered(now_ns)
                                                  : machine_->saw(order_.ordered(block), now_ns));
  return serve();
}

/// Until the next frame is needed, or nothing.
Result<void> CheckedSource::serve() {
  for (;;) {
    switch (machine_->need()) {
      case Need::frame:
        return {};
      case Need::light: {
        const hal::IlluminatorDescription& display = light_->describe();
        const hal::Image picture = TRY(calib::picture_of(machine_->wanted(), display.rows, display.cols));
        const std::int64_t stable_ns = picture.pixels.empty() ? TRY(light_->off()) : TRY(light_->show(picture.pixels));
        machine_->lit(clock_.now_ns(), stable_ns);
        break;
      }
      case Need::commit:
        taken_.push_back(machine_->capture());
        machine_->committed(clock_.now_ns());
        break;
      case Need::nothing:
        end(std::move(taken_));
        return {};
    }
  }
}

void CheckedSource::end(Result<std::vector<calib::Capture>> seen) {
  const std::int64_t now_ns = clock_.now_ns();
  if (machine_) settle_ns_ = static_cast<std::int64_t>(machine_->progress(now_ns).settle_ms * 1e6);
  // A light that was never seen to settle has as long as the plan gives one.
  if (settle_ns_ <= 0) settle_ns_ = static_cast<std::int64_t>(settings_.plan.settle_ms * 1e6);
  machine_.reset();
  {
    const std::lock_guard lock(mutex_);
    looks_.push_back({last_ns_, std::move(seen)});
  }
  // Tried again with frames to come.
  if (light_ != nullptr) static_cast<void>(put_out(now_ns));
}

/// By a new light where the old one fails: a window that was closed is opened once more, and its monitor is let go of.
Result<void> CheckedSource::put_out(std::int64_t now_ns) {
  tried_ns_ = now_ns;
  auto stable_ns = light_->off();
  if (stable_ns) {
    light_.reset();
    const std::int64_t out_ns = clock_.now_ns();
    scene_from_ns_ = std::max(*stable_ns, out_ns + settle_ns_);
    return {};
  }
  if (++tries_ >= most_tries) {
    return fail(
        ErrorCode::io, source_.describe().serial,
        "cannot be shown the scene again, since the light of a check cannot be put out: " + stable_ns.error().text());
  }
  if (auto another = settings_.light()) light_ = std::move(*another);
  return {};
}

void CheckedSource::do_stop() noexcept {
  const bool of_check = machine_ || light_ != nullptr;
  machine_.reset();
  // The eye is left; there is nobody to tell of a lamp that stays lit.
  if (light_ != nullptr) static_cast<void>(light_->off());
  light_.reset();
  source_.stop();
  book(of_check);  // now that the source has counted all
}

hal::FrameAccount CheckedSource::do_account() const noexcept {
  hal::FrameAccount account = source_.account();
  account.checked += account.delivered - delivered_ + of_checks_.total_dropped();
  for (std::size_t k = 0; k < account.dropped.size(); ++k) account.dropped[k] -= of_checks_.dropped[k];
  account.estimated -= of_checks_.estimated;
  account.delivered = delivered_;
  return account;
}

std::optional<CheckLook> CheckedSource::next_look() {
  const std::lock_guard lock(mutex_);
  if (looks_.empty()) return std::nullopt;
  std::optional<CheckLook> look = std::move(looks_.front());
  looks_.pop_front();
  return look;
}

}  // namespace compueye::firmware
