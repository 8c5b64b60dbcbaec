#include "hal/clock.hpp"

#include <chrono>
#include <thread>

namespace compueye::hal {

std::int64_t MonotonicClock::now_ns() const noexcept {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

void MonotonicClock::sleep_until_ns(std::int64_t t_ns) noexcept {
  using namespace std::chrono;
  std::this_thread::sleep_until(steady_clock::time_point(duration_cast<steady_clock::duration>(nanoseconds(t_ns))));
}

void VirtualClock::sleep_until_ns(std::int64_t t_ns) noexcept {
  std::int64_t now = now_.load(std::memory_order_acquire);
  while (now < t_ns && !now_.compare_exchange_weak(now, t_ns, std::memory_order_acq_rel)) {
  }
}

}  // namespace compueye::hal
