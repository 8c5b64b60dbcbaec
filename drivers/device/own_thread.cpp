#include "drivers/device/own_thread.hpp"

#include <pthread.h>
#include <sched.h>

#include <chrono>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace compueye::device {
namespace {

/// How the operating system runs a thread.
struct Scheduling {
  int policy = SCHED_OTHER;
  sched_param parameters{};
  cpu_set_t processors{};
};

Scheduling own_scheduling() noexcept {
  Scheduling own;
  pthread_getschedparam(pthread_self(), &own.policy, &own.parameters);
  pthread_getaffinity_np(pthread_self(), sizeof own.processors, &own.processors);
  return own;
}

/// What it refuses to this thread it has granted to the other, and nobody is worse off than before.
void take_on(const Scheduling& wanted) noexcept {
  pthread_setschedparam(pthread_self(), wanted.policy, &wanted.parameters);
  pthread_setaffinity_np(pthread_self(), sizeof wanted.processors, &wanted.processors);
}

}  // namespace

SharedTime SharedTime::monotonic() {
  return {std::make_shared<hal::MonotonicClock>(),
          [](std::unique_lock<std::mutex>& lock, std::condition_variable& told, std::int64_t until_ns) {
            using namespace std::chrono;
            told.wait_until(lock,
                            steady_clock::time_point(duration_cast<steady_clock::duration>(nanoseconds(until_ns))));
          }};
}

struct OwnThread::Core final : AsideBell {
  explicit Core(SharedTime by) : time(std::move(by)) {}

  const SharedTime time;
  std::mutex mutex;
  std::condition_variable asked, answered;
  // Behind the mutex:
  const AsideCall* call = nullptr;  // null: idle
  Pending pending;
  Scheduling scheduling;
  bool other_scheduling = false;
  bool left = false, gone = false;
  std::shared_ptr<void> belongings;

  void ring() noexcept override {
    // Whoever is about to wait has looked before, or will after this.
    { const std::lock_guard lock(mutex); }
    answered.notify_all();
  }
  /// Waits until `done`, and `until_ns` at most; returns whether it is.
  template <class Done>
  [[nodiscard]] bool wait(std::unique_lock<std::mutex>& lock, std::int64_t until_ns, Done done) {
    while (!done() && time.clock->now_ns() < until_ns) time.wait(lock, answered, until_ns);
    return done();
  }
};

hal::Result<std::unique_ptr<OwnThread>> OwnThread::begin(std::shared_ptr<void> belongings, SharedTime time) {
  auto core = std::make_shared<Core>(std::move(time));
  core->belongings = std::move(belongings);
  try {
    std::thread([core] { work(core); }).detach();
  } catch (const std::system_error& error) {
    return hal::fail(hal::ErrorCode::no_space, "device",
                     std::string("the operating system refused a thread for its calls (") + error.what() + ")");
  }
  return std::unique_ptr<OwnThread>(new OwnThread(std::move(core)));
}

OwnThread::OwnThread(std::shared_ptr<Core> core) noexcept : core_(std::move(core)) {}

OwnThread::~OwnThread() {
  static_cast<void>(leave(core_->time.clock->now_ns()));
}

void OwnThread::work(const std::shared_ptr<Core>& core) noexcept {
  Core& c = *core;
  std::unique_lock lock(c.mutex);
  for (;;) {
    c.asked.wait(lock, [&c] { return c.left || c.call != nullptr; });
    if (c.call == nullptr) break;
    const bool other = std::exchange(c.other_scheduling, false);
    lock.unlock();
    if (other) take_on(c.scheduling);
    c.call->run(c);
    lock.lock();
    c.call = nullptr;
    c.answered.notify_all();
  }
  const std::int64_t now_ns = c.time.clock->now_ns();
  c.pending = {"close", now_ns, now_ns};
  auto belongings = std::move(c.belongings);
  lock.unlock();
  belongings.reset();
  lock.lock();
  c.gone = true;
  c.answered.notify_all();
}

void OwnThread::ask(const AsideCall& call, std::int64_t due_ns) noexcept {
  {
    const std::lock_guard lock(core_->mutex);
    core_->call = &call;
    core_->pending = {call.name, core_->time.clock->now_ns(), due_ns};
  }
  core_->asked.notify_one();
}

bool OwnThread::idle_by(std::int64_t until_ns) noexcept {
  std::unique_lock lock(core_->mutex);
  return core_->wait(lock, until_ns, [this] { return core_->call == nullptr; });
}

bool OwnThread::idle_or(const std::function<bool()>& done, std::int64_t until_ns) noexcept {
  std::unique_lock lock(core_->mutex);
  return core_->wait(lock, until_ns, [&] { return core_->call == nullptr || done(); });
}

OwnThread::Pending OwnThread::pending() const noexcept {
  const std::lock_guard lock(core_->mutex);
  return core_->pending;
}

void OwnThread::run_as_caller() noexcept {
  const Scheduling own = own_scheduling();
  const std::lock_guard lock(core_->mutex);
  // A call that has yet to begin reads it without the lock.
  if (core_->call != nullptr) return;
  core_->scheduling = own;
  core_->other_scheduling = true;
}

bool OwnThread::leave(std::int64_t until_ns) noexcept {
  std::unique_lock lock(core_->mutex);
  core_->left = true;
  core_->asked.notify_one();
  return core_->wait(lock, until_ns, [this] { return core_->gone; });
}

}  // namespace compueye::device
