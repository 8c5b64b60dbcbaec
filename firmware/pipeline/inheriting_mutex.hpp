#pragma once

#include <pthread.h>

namespace compueye::firmware {

/// A mutex whose holder runs at the priority of the most urgent thread that waits for it (PTHREAD_PRIO_INHERIT), so
/// that the acquire thread, at a real-time priority, never waits for a solver that something of a priority in between
/// keeps from running. Where the system knows no such thing it is a plain one. A std::mutex cannot be asked for it.
class InheritingMutex {
 public:
  InheritingMutex() noexcept {
    pthread_mutexattr_t wanted;
    pthread_mutexattr_init(&wanted);
    inherits_ =
        pthread_mutexattr_setprotocol(&wanted, PTHREAD_PRIO_INHERIT) == 0 && pthread_mutex_init(&mutex_, &wanted) == 0;
    if (!inherits_) pthread_mutex_init(&mutex_, nullptr);
    pthread_mutexattr_destroy(&wanted);
  }
  InheritingMutex(const InheritingMutex&) = delete;
  InheritingMutex& operator=(const InheritingMutex&) = delete;
  ~InheritingMutex() { pthread_mutex_destroy(&mutex_); }

  void lock() noexcept { pthread_mutex_lock(&mutex_); }
  void unlock() noexcept { pthread_mutex_unlock(&mutex_); }
  [[nodiscard]] bool inherits() const noexcept { return inherits_; }
  [[nodiscard]] pthread_mutex_t* native() noexcept { return &mutex_; }

 private:
  pthread_mutex_t mutex_;
  bool inherits_ = false;
};

/// What threads wait on behind an InheritingMutex.
class InheritingCondition {
 public:
  InheritingCondition() noexcept { pthread_cond_init(&condition_, nullptr); }
  InheritingCondition(const InheritingCondition&) = delete;
  InheritingCondition& operator=(const InheritingCondition&) = delete;
  ~InheritingCondition() { pthread_cond_destroy(&condition_); }

  /// Until `done()`, which is asked with the mutex locked, as it is before and after.
  template <class Done>
  void wait(InheritingMutex& locked, Done done) noexcept {
    while (!done()) pthread_cond_wait(&condition_, locked.native());
  }
  void notify_one() noexcept { pthread_cond_signal(&condition_); }
  void notify_all() noexcept { pthread_cond_broadcast(&condition_); }

 private:
  pthread_cond_t condition_;
};

}  // namespace compueye::firmware
