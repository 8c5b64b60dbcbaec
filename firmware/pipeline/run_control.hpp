#pragma once

#include <atomic>
#include <optional>
#include <utility>

#include "firmware/pipeline/block_queue.hpp"
#include "firmware/pipeline/frame_slots.hpp"
#include "firmware/pipeline/run_summary.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// How the threads of one run agree that it is over. The first cause counts.
class RunControl {
 public:
  RunControl(const std::atomic<bool>& stop, BlockQueue<RawSlot>& raw, BlockQueue<CorrectedSlot>& corrected,
             BlockQueue<PictureSlot>& pictures) noexcept
      : stop_(stop), raw_(raw), corrected_(corrected), pictures_(pictures) {}

  /// Every stage asks this after each frame, so whichever is awake first ends the run for those that wait.
  [[nodiscard]] bool stop_seen() noexcept {
    if (stop_.load(std::memory_order_relaxed)) end_now(Ending::stop_requested);
    return over_.load(std::memory_order_acquire);
  }

  /// Ends the run at once: what waits in a queue is given up.
  void end_now(Ending ending, std::optional<hal::Error> error = std::nullopt) noexcept {
    note(ending, std::move(error));
    over_.store(true, std::memory_order_release);
    raw_.abort();
    corrected_.abort();
    pictures_.abort();
  }

  /// The input failed: frames already taken in are still worth delivering, so nothing is given up here.
  void end_input(hal::Error error) noexcept { note(Ending::source_failed, std::move(error)); }

  /// After every thread was joined.
  [[nodiscard]] Ending ending() const noexcept { return has_ending_ ? ending_ : Ending::end_of_stream; }
  [[nodiscard]] const std::optional<hal::Error>& error() const noexcept { return error_; }

 private:
  void note(Ending ending, std::optional<hal::Error> error) noexcept {
    if (has_ending_.exchange(true)) return;
    ending_ = ending;
    error_ = std::move(error);
  }

  const std::atomic<bool>& stop_;
  BlockQueue<RawSlot>& raw_;
  BlockQueue<CorrectedSlot>& corrected_;
  BlockQueue<PictureSlot>& pictures_;
  std::atomic<bool> over_{false};
  std::atomic<bool> has_ending_{false};
  Ending ending_ = Ending::end_of_stream;
  std::optional<hal::Error> error_;
};

}  // namespace compueye::firmware
