#include "drivers/device/hang_proof_source.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "hal/try.hpp"

namespace compueye::device {
namespace {

constexpr hal::Counter hang_counter{"hang", "calls of the driver that did not come back in their time"};

constexpr std::int64_t counters_limit_ns = 200'000'000;  // of the wait for a read to come back

std::string in_tenths(std::int64_t ns) {
  const std::int64_t tenths = ns / 100'000'000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
}

}  // namespace

std::string hang_reference() {
  std::string text = "| call | waited for | then |\n|---|---|---|\n";
  for (const HangLimit& each : hang_limits) {
    text += "| " + std::string(each.name) + " | " + in_tenths(each.budget_ns) +
            (each.call == DeviceCall::read ? " behind its deadline" : "") + " | " + std::string(each.then) + " |\n";
  }
  return text;
}

hal::Result<std::unique_ptr<HangProofSource>> HangProofSource::create(std::string device, Open open, SharedTime time,
                                                                      std::size_t frames_ahead) {
  std::unique_ptr<HangProofSource> source(new HangProofSource(std::move(device), std::move(time), frames_ahead));
  TRY(source->open(std::move(open)));
  return source;
}

HangProofSource::HangProofSource(std::string device, SharedTime time, std::size_t frames_ahead)
    : time_(std::move(time)), frames_ahead_(frames_ahead) {
  description_.serial = std::move(device);
}

HangProofSource::~HangProofSource() {
  static_cast<void>(close());
}

hal::Result<void> HangProofSource::open(Open open) {
  device_ = std::make_shared<CalledDevice>(time_.clock);
  device_->open = std::move(open);
  thread_ = TRY(OwnThread::begin(device_, time_));
  if (!made(DeviceCall::open, now_ns() + limit_of(DeviceCall::open).budget_ns)) return tl::unexpected(hangs());
  TRY(std::move(device_->done));
  source_ = device_->source.get();
  description_ = source_->describe();
  counters_ = source_->counters();
  FrameRing& ring = device_->ring.emplace(frames_ahead_ + 1, static_cast<std::size_t>(description_.channels));
  has_frame_ = [&ring] { return ring.has_frame(); };
  see(device_->books);
  return {};
}

/// Makes a call. False: it, or the one before, is not back by `until_ns`.
bool HangProofSource::made(DeviceCall call, std::int64_t until_ns) noexcept {
  device_->wanted.store(true, std::memory_order_relaxed);
  if (!thread_->idle_by(until_ns)) return false;
  thread_->ask(device_->call(call), until_ns);
  return thread_->idle_by(until_ns);
}

/// Of a frame or a call that came back.
void HangProofSource::see(const SourceBooks& books) noexcept {
  books_ = books;
  hanging_.store(false, std::memory_order_relaxed);
  hang_.reset();
}

/// Of the call that is being made; reading is many of them.
OwnThread::Pending HangProofSource::pending() const noexcept {
  OwnThread::Pending pending = thread_->pending();
  if (device_ && pending.call == limit_of(DeviceCall::read).name) {
    pending.since_ns = device_->read_since_ns.load(std::memory_order_relaxed);
    pending.due_ns = device_->read_due_ns.load(std::memory_order_relaxed);
  }
  return pending;
}

hal::Error HangProofSource::hangs() {
  const OwnThread::Pending at = pending();
  if (!hang_) hangs_.fetch_add(1, std::memory_order_relaxed);
  hanging_.store(true, std::memory_order_relaxed);
  hang_ = hal::Error{hal::ErrorCode::timeout, description_.serial,
                     "its driver has not come back from '" + std::string(at.call) + "' for " +
                         in_tenths(now_ns() - at.since_ns) +
                         "; unplug the eye and plug it in again, or restart the machine"};
  return *hang_;
}

hal::Result<void> HangProofSource::do_start() {
  given_up_ = reading_ = false;
  reader_ = {};
  delivered_ = 0;
  hangs_.store(0, std::memory_order_relaxed);
  hanging_.store(false, std::memory_order_relaxed);
  hang_.reset();
  books_ = {};
  if (!device_) return hal::fail(hal::ErrorCode::usage, description_.serial, "is closed");
  if (!made(DeviceCall::start, now_ns() + limit_of(DeviceCall::start).budget_ns)) return tl::unexpected(hangs());
  device_->ring->clear();
  see(device_->books);
  counters_ = source_->counters();
  return std::move(device_->done);
}

hal::Result<hal::SampleBlock> HangProofSource::do_read(std::int64_t deadline_ns) {
  if (given_up_) {
    return tl::unexpected(hal::Error{hal::ErrorCode::disconnected, hang_->place, hang_->sentence});
  }
  const std::int64_t until_ns =
      std::min(deadline_ns, std::numeric_limits<std::int64_t>::max() - latest_answer_ns) + latest_answer_ns;
  device_->deadline_ns.store(deadline_ns, std::memory_order_relaxed);
  for (bool asked = false;;) {
    const bool idle = thread_->idle_by(std::numeric_limits<std::int64_t>::min());
    if (const RingFrame* const frame = device_->ring->pop()) {
      ++delivered_;
      see(frame->books);
      return frame->block;
    }
    if (!idle) {
      if (!thread_->idle_or(has_frame_, until_ns)) return late();
      continue;
    }
    if (auto error = end_of_reading(asked)) return tl::unexpected(std::move(*error));
    if (const auto caller = std::this_thread::get_id(); caller != reader_) {
      reader_ = caller;
      thread_->run_as_caller();
    }
    device_->wanted.store(false, std::memory_order_relaxed);
    thread_->ask(device_->call(DeviceCall::read), deadline_ns);
    reading_ = asked = true;
  }
}

/// The error that reading has come to; nothing: it may go on. `asked`: by the read() that wants to know.
std::optional<hal::Error> HangProofSource::end_of_reading(bool asked) {
  if (!std::exchange(reading_, false)) return std::nullopt;
  see(device_->books);
  auto ended = std::exchange(device_->ended, {});
  // That nothing came by an earlier deadline is no answer to this one.
  if (ended || (!asked && ended.error().code == hal::ErrorCode::timeout)) return std::nullopt;
  return std::move(ended.error());
}

/// The answer while nothing else is known.
hal::Result<hal::SampleBlock> HangProofSource::late() {
  const std::int64_t over_ns = now_ns() - pending().due_ns;
  if (over_ns < limit_of(DeviceCall::read).budget_ns) return hal::timed_out();
  hal::Error error = hangs();
  if (over_ns < hang_given_up_after_ns) return hal::timed_out();
  given_up_ = true;
  hanging_.store(false, std::memory_order_relaxed);
  error.code = hal::ErrorCode::disconnected;
  return tl::unexpected(std::move(error));
}

void HangProofSource::do_stop() noexcept {
  reading_ = false;
  if (!made(DeviceCall::stop, now_ns() + limit_of(DeviceCall::stop).budget_ns)) {
    static_cast<void>(hangs());
    return;
  }
  see(device_->books);
  const std::uint64_t unread = books_.account.delivered - delivered_;
  books_.account.delivered -= unread;
  books_.account.drops(hal::DropReason::stopped) += unread;
  counters_ = source_->counters();
}

hal::Result<void> HangProofSource::act(Act act) {
  const std::int64_t until_ns = now_ns() + limit_of(DeviceCall::set).budget_ns;
  if (!device_) return hal::fail(hal::ErrorCode::usage, description_.serial, "is closed");
  device_->wanted.store(true, std::memory_order_relaxed);
  if (!thread_->idle_by(until_ns)) return tl::unexpected(hangs());
  device_->act = std::move(act);
  if (!made(DeviceCall::set, until_ns)) return tl::unexpected(hangs());
  return std::move(device_->done);
}

hal::Result<void> HangProofSource::close() {
  stop();
  source_ = nullptr;
  if (!std::exchange(device_, nullptr) || !thread_) return {};
  if (thread_->leave(now_ns() + limit_of(DeviceCall::close).budget_ns)) return {};
  return tl::unexpected(hangs());
}

bool HangProofSource::do_recovering() const noexcept {
  return hanging_.load(std::memory_order_relaxed) || (source_ != nullptr && source_->recovering());
}

std::uint64_t HangProofSource::do_faults() const noexcept {
  return hangs_.load(std::memory_order_relaxed) + (source_ != nullptr ? source_->faults() : 0);
}

std::vector<hal::Counter> HangProofSource::do_counters() const {
  if (device_) device_->wanted.store(true, std::memory_order_relaxed);
  const bool idle = device_ && thread_->idle_by(now_ns() + counters_limit_ns);
  std::vector<hal::Counter> counters = idle ? source_->counters() : counters_;
  counters.push_back(hang_counter);
  counters.back().count = hangs_.load(std::memory_order_relaxed);
  return counters;
}

}  // namespace compueye::device
