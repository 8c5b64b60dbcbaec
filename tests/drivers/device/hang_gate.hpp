#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "drivers/device/shared_time.hpp"
#include "hal/clock.hpp"

/// Calls of a driver that do not come back, in virtual time.
namespace compueye::device::tests {

/// What every call of a driver passes by, by its name; one of them may be made to hang there. Time goes on by whoever
/// waits for what hangs, exactly as far as he waits: nothing here looks at a real clock.
class HangGate {
 public:
  /// The n-th call of that name from now on, and whatever comes behind it, does not come back until release().
  void hang_at(std::string call, int nth = 1) {
    const std::lock_guard lock(mutex_);
    wanted_ = std::move(call);
    left_ = nth;
  }
  /// By the driver, whichever thread it is on.
  void pass(const std::string& call) {
    std::unique_lock lock(mutex_);
    ++passed_[call];
    changed_.notify_all();
    if (call != wanted_ || --left_ != 0) return;
    hangs_ = true;
    if (waiting_on_ != nullptr) {
      std::mutex* const theirs = waiting_mutex_;
      std::condition_variable* const told = waiting_on_;
      lock.unlock();
      // Whoever waits has let go of it.
      { const std::lock_guard woken(*theirs); }
      told->notify_all();
      lock.lock();
    }
    changed_.notify_all();
    changed_.wait(lock, [this] { return !hangs_; });
  }
  void release() {
    const std::lock_guard lock(mutex_);
    hangs_ = false;
    wanted_.clear();
    changed_.notify_all();
  }
  [[nodiscard]] bool hangs() {
    const std::lock_guard lock(mutex_);
    return hangs_;
  }
  /// Until a call of that name was made so often in all.
  void wait_for(const std::string& call, int times) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return passed_[call] >= times; });
  }
  [[nodiscard]] int passed(const std::string& call) {
    const std::lock_guard lock(mutex_);
    return passed_[call];
  }

  /// SharedTime::wait.
  void wait(std::unique_lock<std::mutex>& lock, std::condition_variable& told, std::int64_t until_ns,
            hal::Clock& clock) {
    {
      const std::lock_guard own(mutex_);
      if (hangs_) {
        clock.sleep_until_ns(until_ns);
        return;
      }
      waiting_mutex_ = lock.mutex();
      waiting_on_ = &told;
    }
    told.wait(lock);
    const std::lock_guard own(mutex_);
    waiting_on_ = nullptr;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string wanted_;
  int left_ = 0;
  bool hangs_ = false;
  std::map<std::string, int> passed_;
  std::mutex* waiting_mutex_ = nullptr;
  std::condition_variable* waiting_on_ = nullptr;
};

/// Both are kept alive by what hangs.
inline SharedTime time_of(const std::shared_ptr<hal::Clock>& clock, const std::shared_ptr<HangGate>& gate) {
  return {clock, [clock, gate](std::unique_lock<std::mutex>& lock, std::condition_variable& told,
                               std::int64_t until_ns) { gate->wait(lock, told, until_ns, *clock); }};
}

}  // namespace compueye::device::tests
