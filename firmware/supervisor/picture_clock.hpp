#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/pipeline/frame_observer.hpp"
#include "hal/clock.hpp"

namespace compueye::firmware {

/// When pictures came, and which of the last 32 were late; hands them on to the next observer. Told by the publish
/// thread, read by any; what is read together may be of two neighbouring pictures.
class PictureClock final : public FrameObserver {
 public:
  /// Both must outlive it.
  PictureClock(const hal::Clock& clock, FrameObserver& next) noexcept : clock_(clock), next_(next) {}

  void published(const PublishedFrame& frame) noexcept override {
    constexpr auto relaxed = std::memory_order_relaxed;
    const std::int64_t now_ns = clock_.now_ns();
    if (count_.load(relaxed) > 0) interval_ns_.store(now_ns - at_ns_.load(relaxed), relaxed);
    at_ns_.store(now_ns, relaxed);
    late_bits_.store((late_bits_.load(relaxed) << 1U) | (frame.late ? 1U : 0U), relaxed);
    count_.fetch_add(1, std::memory_order_release);
    next_.published(frame);
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_.load(std::memory_order_acquire); }
  /// Of the last one; meaningful when count() > 0.
  [[nodiscard]] std::int64_t at_ns() const noexcept { return at_ns_.load(std::memory_order_relaxed); }
  /// Between the last two, 0: there were none.
  [[nodiscard]] std::int64_t interval_ns() const noexcept { return interval_ns_.load(std::memory_order_relaxed); }
  /// The last one lowest.
  [[nodiscard]] std::uint32_t late_bits() const noexcept { return late_bits_.load(std::memory_order_relaxed); }

 private:
  const hal::Clock& clock_;
  FrameObserver& next_;
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> at_ns_{0}, interval_ns_{0};
  std::atomic<std::uint32_t> late_bits_{0};
};

}  // namespace compueye::firmware
