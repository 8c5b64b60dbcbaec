#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>

#include "hal/clock.hpp"

namespace compueye::device {

/// A clock by which threads wait for one another, and which outlives each of them.
struct SharedTime {
  std::shared_ptr<hal::Clock> clock;  ///< never null
  /// Until `told` is notified or it is `until_ns`; it may return before both. `lock` is held before and after.
  std::function<void(std::unique_lock<std::mutex>& lock, std::condition_variable& told, std::int64_t until_ns)> wait;

  /// The kernel's monotonic one.
  [[nodiscard]] static SharedTime monotonic();
};

}  // namespace compueye::device
