#include "drivers/device/hang_proof_lines.hpp"

#include <exception>
#include <utility>

#include "drivers/device/hang_limits.hpp"
#include "hal/try.hpp"

namespace compueye::device {

/// What the thread works on: its own while a call is being made.
struct HangProofLines::Lines {
  explicit Lines(std::unique_ptr<hal::OutputLines> wrapped) : lines(std::move(wrapped)) {}

  /// What goes wrong beside errors is one, too.
  template <class Run>
  [[nodiscard]] AsideCall call(std::string_view name, Run run) {
    return {name, [this, run](AsideBell&) {
              try {
                done = run(*this);
              } catch (const std::exception&) {
                done = hal::fail(hal::ErrorCode::no_space, lines->name(), "out of memory");
              }
            }};
  }

  std::unique_ptr<hal::OutputLines> lines;
  std::uint32_t levels = 0;  ///< that are asked for
  hal::Result<void> done;
  const AsideCall open = call("open", [](Lines& l) { return l.lines->open(); });
  const AsideCall set = call("set", [](Lines& l) { return l.lines->set(l.levels); });
  const AsideCall close = call("close", [](Lines& l) {
    l.lines->close();
    return hal::Result<void>();
  });
};

HangProofLines::HangProofLines(std::unique_ptr<hal::OutputLines> lines, SharedTime time)
    : time_(std::move(time)), name_(lines->name()), count_(lines->count()) {
  lines_ = std::make_shared<Lines>(std::move(lines));
}

HangProofLines::~HangProofLines() {
  lines_.reset();
  if (thread_) static_cast<void>(thread_->leave(time_.clock->now_ns() + limit_of(DeviceCall::close).budget_ns));
}

/// Nothing is asked for while a call before hangs.
hal::Result<void> HangProofLines::make(const AsideCall& call, std::int64_t budget_ns) {
  const std::int64_t until_ns = time_.clock->now_ns() + budget_ns;
  if (thread_->idle_by(until_ns)) thread_->ask(call, until_ns);
  if (thread_->idle_by(until_ns)) return std::exchange(lines_->done, {});
  const OwnThread::Pending pending = thread_->pending();
  return hal::fail(hal::ErrorCode::timeout, name_,
                   "the driver has not come back from '" + std::string(pending.call) + "' for " +
                       std::to_string((time_.clock->now_ns() - pending.since_ns) / 1'000'000) +
                       " ms; look at the kernel's log, and restart the machine");
}

hal::Result<void> HangProofLines::open() {
  if (!thread_) thread_ = TRY(OwnThread::begin(lines_, time_));
  return make(lines_->open, limit_of(DeviceCall::set).budget_ns);
}

void HangProofLines::close() noexcept {
  if (thread_) static_cast<void>(make(lines_->close, limit_of(DeviceCall::close).budget_ns));
}

hal::Result<void> HangProofLines::set(std::uint32_t levels) {
  if (!thread_) return hal::fail(hal::ErrorCode::usage, name_, "not open; call open() first");
  // The call before may still look at them.
  if (thread_->idle_by(time_.clock->now_ns() + limit_of(DeviceCall::set).budget_ns)) lines_->levels = levels;
  return make(lines_->set, limit_of(DeviceCall::set).budget_ns);
}

}  // namespace compueye::device
