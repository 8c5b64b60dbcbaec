#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "firmware/pipeline/frame_observer.hpp"
#include "firmware/sinks/live_status.hpp"
#include "hal/frame_sink.hpp"

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
  /// Which frame of the device it is.
  [[nodiscard]] std::uint64_t frame(std::size_t index) const noexcept { return frames_[index]; }
  /// The last one delivered, whether kept or not; meaningful when delivered() > 0.
  [[nodiscard]] std::span<const float> last() const noexcept { return last_; }
  [[nodiscard]] std::uint64_t last_frame() const noexcept { return last_frame_; }
  // From any thread:
  /// So far.
  [[nodiscard]] std::uint64_t delivered() const noexcept { return status_.delivered(); }
  [[nodiscard]] const LiveStatus& status() const noexcept { return status_; }
  /// LiveStatus::checks_are_counted_by().
  void checks_are_counted_by(const std::atomic<std::uint64_t>& frames, const std::atomic<bool>& go_on) noexcept {
    status_.checks_are_counted_by(frames, go_on);
  }
  /// LiveStatus::source_is().
  void source_is(std::uint64_t faults, bool recovering) noexcept { status_.source_is(faults, recovering); }
  /// LiveStatus::misfit_is() and left_out_are().
  void response_is(double misfit, std::uint64_t left_out) noexcept {
    status_.misfit_is(misfit);
    status_.left_out_are(left_out);
  }
  /// LiveStatus::picture_is().
  void picture_is(PictureAge age) noexcept { status_.picture_is(age); }

 private:
  [[nodiscard]] std::span<float> slot(std::size_t index) noexcept;

  std::size_t pixels_;
  std::size_t capacity_;
  std::vector<float> pictures_;
  std::vector<std::uint64_t> frames_;
  std::vector<float> last_;
  std::size_t kept_ = 0;
  std::uint64_t stride_ = 1;
  std::uint64_t last_frame_ = 0;
  LiveStatus status_;
};

/// Tells how far a run is, from a thread of its own, so that the frame path neither writes nor allocates for it. From
/// construction to destruction.
class RunWatch {
 public:
  /// `tell` is called ten times a second.
  explicit RunWatch(std::function<void()> tell);
  RunWatch(const RunWatch&) = delete;
  RunWatch& operator=(const RunWatch&) = delete;
  ~RunWatch();

 private:
  void watch();

  std::function<void()> tell_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace compueye::firmware
