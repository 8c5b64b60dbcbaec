#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "firmware/pipeline/frame_observer.hpp"
#include "hal/frame_sink.hpp"
#include "recon/setup/factor.hpp"

namespace compueye::firmware {

/// Keeps pictures of a run for the figures that are computed when it is over, because computing them takes heap memory
/// and time that the frame path must not spend. Every picture is kept while there is room; then every second of those
/// is given up and of the following every second is kept, and so on: an even selection of a run of any length. Nothing
/// is allocated after construction.
class FrameKeeper final : public FrameObserver {
 public:
  /// Room for `expected` pictures (0: unknown) within `most_bytes`, and for two at least.
  FrameKeeper(hal::FrameFormat format, std::uint64_t expected, std::size_t most_bytes = std::size_t{64} << 20U);

  void published(const PublishedFrame& published) noexcept override;

  /// Pictures kept, in order.
  [[nodiscard]] std::size_t kept() const noexcept { return kept_; }
  [[nodiscard]] std::span<const float> picture(std::size_t index) const noexcept;
  /// The last one delivered, whether kept or not; meaningful when delivered() > 0.
  [[nodiscard]] std::span<const float> last() const noexcept { return last_; }
  [[nodiscard]] std::uint64_t last_frame() const noexcept { return last_frame_; }
  /// So far; from any thread.
  [[nodiscard]] std::uint64_t delivered() const noexcept { return delivered_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] std::span<float> slot(std::size_t index) noexcept;

  std::size_t pixels_;
  std::size_t capacity_;
  std::vector<float> pictures_;
  std::vector<float> last_;
  std::size_t kept_ = 0;
  std::uint64_t stride_ = 1;
  std::uint64_t last_frame_ = 0;
  std::atomic<std::uint64_t> delivered_{0};
};

/// Shows on stderr how far a run is, from a thread of its own, so that the frame path neither writes nor allocates for
/// it. From construction to destruction.
class RunWatch {
 public:
  /// `frames` to deliver, 0 = unknown. `keeper` must outlive the watch, which alone uses `progress` meanwhile.
  RunWatch(const FrameKeeper& keeper, std::uint64_t frames, recon::Progress progress);
  RunWatch(const RunWatch&) = delete;
  RunWatch& operator=(const RunWatch&) = delete;
  ~RunWatch();

 private:
  void watch(std::uint64_t frames);

  const FrameKeeper& keeper_;
  recon::Progress progress_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace compueye::firmware
