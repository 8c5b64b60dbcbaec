#pragma once

#include <atomic>
#include <cstdint>

namespace compueye::hal {

/// Monotonic time in nanoseconds from an arbitrary origin. Everything that waits takes a Clock, so that tests run in
/// virtual time. Safe to call from several threads.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;
  /// Returns at once when `t_ns` has passed.
  virtual void sleep_until_ns(std::int64_t t_ns) noexcept = 0;
};

class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override;
  void sleep_until_ns(std::int64_t t_ns) noexcept override;
};

/// Time that passes only when somebody sleeps or calls advance(): a sleep moves the clock to its end and returns.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(std::int64_t start_ns = 0) noexcept : now_(start_ns) {}
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_.load(std::memory_order_acquire); }
  void sleep_until_ns(std::int64_t t_ns) noexcept override;
  /// `by_ns` >= 0.
  void advance(std::int64_t by_ns) noexcept { now_.fetch_add(by_ns, std::memory_order_acq_rel); }

 private:
  std::atomic<std::int64_t> now_;
};

}  // namespace compueye::hal
