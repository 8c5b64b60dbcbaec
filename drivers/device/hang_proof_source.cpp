#include "drivers/device/hang_proof_source.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <utility>

#include "hal/try.hpp"

namespace compueye::device {
namespace {

constexpr hal::Counter hang_counter{"hang", "calls of the driver that did not come back in their time"};

std::string in_tenths(std::int64_t ns) {
  const std::int64_t tenths = ns / 100'000'000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
}

}  // namespace

/// What the calls work on, and what they leave. It is the thread's while a call is being made, and the reader's
/// otherwise.
struct HangProofSource::Device {
  explicit Device(std::shared_ptr<hal::Clock> by) : clock(std::move(by)) {}

  [[nodiscard]] const AsideCall& call(DeviceCall which) const noexcept {
    return calls[static_cast<std::size_t>(which)];
  }

  /// One of the rows, with what goes wrong beside errors.
  template <class Run>
  [[nodiscard]] AsideCall row(DeviceCall which, Run run) {
    return {limit_of(which).name, [this, run] {
              try {
                run(*this);
              } catch (const std::exception&) {
                done = hal::fail(hal::ErrorCode::no_space, "device", "out of memory");
                block = tl::unexpected(done.error());
              }
              if (!source) return;
              account = source->account();
              outages = source->outages();
              withheld = source->withheld();
            }};
  }

  const std::shared_ptr<hal::Clock> clock;  // outlives the source
  Open open;
  Source source;
  // What is asked:
  std::int64_t deadline_ns = 0;
  Act act;
  // What came of it:
  hal::Result<void> done;
  hal::Result<hal::SampleBlock> block = hal::timed_out();
  hal::FrameAccount account;
  std::uint64_t outages = 0;
  bool withheld = false;

  const std::array<AsideCall, hang_limits.size()> calls{
      row(DeviceCall::open,
          [](Device& d) {
            auto opened = d.open(*d.clock);
            d.done = opened ? hal::Result<void>() : tl::unexpected(std::move(opened.error()));
            if (opened) d.source = std::move(*opened);
          }),
      // One that somebody went on without may have started it, or not have stopped it.
      row(DeviceCall::start,
          [](Device& d) {
            d.source->stop();
            d.done = d.source->start();
          }),
      row(DeviceCall::read, [](Device& d) { d.block = d.source->read(d.deadline_ns); }),
      row(DeviceCall::set, [](Device& d) { d.done = std::exchange(d.act, nullptr)(*d.source); }),
      row(DeviceCall::stop, [](Device& d) { d.source->stop(); }),
      row(DeviceCall::close, [](Device& d) { d.source.reset(); }),
  };
};

std::string hang_reference() {
  std::string text = "| call | waited for | then |\n|---|---|---|\n";
  for (const HangLimit& each : hang_limits) {
    text += "| " + std::string(each.name) + " | " + in_tenths(each.budget_ns) +
            (each.call == DeviceCall::read ? " behind its deadline" : "") + " | " + std::string(each.then) + " |\n";
  }
  return text;
}

hal::Result<std::unique_ptr<HangProofSource>> HangProofSource::create(std::string device, Open open, SharedTime time) {
  std::unique_ptr<HangProofSource> source(new HangProofSource(std::move(device), std::move(time)));
  TRY(source->open(std::move(open)));
  return source;
}

HangProofSource::HangProofSource(std::string device, SharedTime time) : time_(std::move(time)) {
  description_.serial = std::move(device);
}

HangProofSource::~HangProofSource() {
  static_cast<void>(close());
}

hal::Result<void> HangProofSource::open(Open open) {
  device_ = std::make_shared<Device>(time_.clock);
  device_->open = std::move(open);
  thread_ = TRY(OwnThread::begin(device_, time_));
  if (!made(DeviceCall::open, now_ns() + limit_of(DeviceCall::open).budget_ns)) return tl::unexpected(hangs());
  TRY(std::move(device_->done));
  source_ = device_->source.get();
  description_ = source_->describe();
  counters_ = source_->counters();
  see();
  return {};
}

/// Makes a call. False: it, or the one before, is not back by `until_ns`.
bool HangProofSource::made(DeviceCall call, std::int64_t until_ns) noexcept {
  if (!thread_->idle_by(until_ns)) return false;
  thread_->ask(device_->call(call), until_ns);
  return thread_->idle_by(until_ns);
}

/// What a call has left that came back.
void HangProofSource::see() noexcept {
  account_ = device_->account;
  outages_ = device_->outages;
  withheld_ = device_->withheld;
  hanging_.store(false, std::memory_order_relaxed);
  hang_.reset();
}

hal::Error HangProofSource::hangs() {
  const OwnThread::Pending pending = thread_->pending();
  if (!hang_) hangs_.fetch_add(1, std::memory_order_relaxed);
  hanging_.store(true, std::memory_order_relaxed);
  hang_ = hal::Error{hal::ErrorCode::timeout, description_.serial,
                     "its driver has not come back from '" + std::string(pending.call) + "' for " +
                         in_tenths(now_ns() - pending.since_ns) +
                         "; unplug the eye and plug it in again, or restart the machine"};
  return *hang_;
}

hal::Result<void> HangProofSource::do_start() {
  given_up_ = reading_ = false;
  reader_ = {};
  hangs_.store(0, std::memory_order_relaxed);
  hanging_.store(false, std::memory_order_relaxed);
  hang_.reset();
  account_ = {};
  outages_ = 0;
  if (!device_) return hal::fail(hal::ErrorCode::usage, description_.serial, "is closed");
  if (!made(DeviceCall::start, now_ns() + limit_of(DeviceCall::start).budget_ns)) return tl::unexpected(hangs());
  see();
  counters_ = source_->counters();
  return std::move(device_->done);
}

hal::Result<hal::SampleBlock> HangProofSource::do_read(std::int64_t deadline_ns) {
  if (given_up_) {
    return tl::unexpected(hal::Error{hal::ErrorCode::disconnected, hang_->place, hang_->sentence});
  }
  const std::int64_t until_ns =
      std::min(deadline_ns, std::numeric_limits<std::int64_t>::max() - latest_answer_ns) + latest_answer_ns;
  for (bool asked = false;;) {
    if (!thread_->idle_by(until_ns)) return late();
    if (reading_) {
      reading_ = false;
      see();
      auto block = std::exchange(device_->block, hal::timed_out());
      // That nothing came by an earlier deadline is no answer to this one.
      if (block || asked || block.error().code != hal::ErrorCode::timeout) return block;
    }
    if (const auto caller = std::this_thread::get_id(); caller != reader_) {
      reader_ = caller;
      thread_->run_as_caller();
    }
    device_->deadline_ns = deadline_ns;
    thread_->ask(device_->call(DeviceCall::read), deadline_ns);
    reading_ = asked = true;
  }
}

/// The answer while nothing else is known.
hal::Result<hal::SampleBlock> HangProofSource::late() {
  const std::int64_t over_ns = now_ns() - thread_->pending().due_ns;
  if (over_ns < limit_of(DeviceCall::read).budget_ns) return hal::timed_out();
  hal::Error error = hangs();
  if (over_ns < hang_given_up_after_ns) return hal::timed_out();
  given_up_ = true;
  hanging_.store(false, std::memory_order_relaxed);
  error.code = hal::ErrorCode::disconnected;
  return tl::unexpected(std::move(error));
}

void HangProofSource::do_stop() noexcept {
  const std::int64_t until_ns = now_ns() + limit_of(DeviceCall::stop).budget_ns;
  const bool idle = thread_->idle_by(until_ns);
  const bool unread = idle && std::exchange(reading_, false) && device_->block;
  if (!idle || !made(DeviceCall::stop, until_ns)) {
    static_cast<void>(hangs());
    return;
  }
  see();
  if (unread) {
    --account_.delivered;
    ++account_.drops(hal::DropReason::stopped);
  }
  counters_ = source_->counters();
}

hal::Result<void> HangProofSource::act(Act act) {
  const std::int64_t until_ns = now_ns() + limit_of(DeviceCall::set).budget_ns;
  if (!device_) return hal::fail(hal::ErrorCode::usage, description_.serial, "is closed");
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
  const bool idle = device_ && thread_->idle_by(now_ns());
  std::vector<hal::Counter> counters = idle ? source_->counters() : counters_;
  counters.push_back(hang_counter);
  counters.back().count = hangs_.load(std::memory_order_relaxed);
  return counters;
}

}  // namespace compueye::device
