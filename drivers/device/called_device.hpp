#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "drivers/device/frame_ring.hpp"
#include "drivers/device/hang_limits.hpp"
#include "drivers/device/own_thread.hpp"
#include "hal/clock.hpp"
#include "hal/sample_source.hpp"

namespace compueye::device {

/// What the thread of a HangProofSource works on: a source, the calls that are made of it, and what they leave. It is
/// the thread's while a call is being made and the reader's otherwise, but for what is atomic and for the ring.
struct CalledDevice {
  using Source = std::unique_ptr<hal::SampleSource>;

  explicit CalledDevice(std::shared_ptr<hal::Clock> by);

  /// Of every row but close, which is done by leaving the thread.
  [[nodiscard]] const AsideCall& call(DeviceCall which) const noexcept {
    return calls[static_cast<std::size_t>(which)];
  }

  const std::shared_ptr<hal::Clock> clock;  // outlives the source
  Source source;
  std::optional<FrameRing> ring;  // once it is open

  // What is asked:
  std::function<hal::Result<Source>(hal::Clock&)> open;
  std::function<hal::Result<void>(hal::SampleSource&)> act;
  std::atomic<std::int64_t> deadline_ns{0};  ///< until when frames are read
  std::atomic<bool> wanted{false};           ///< for something else: reading comes to its end

  // What came of it:
  hal::Result<void> done;                                      ///< of the last call but read
  hal::Result<void> ended;                                     ///< why reading ended: by an error, or as it should
  SourceBooks books;                                           ///< when the last call came back
  std::atomic<std::int64_t> read_since_ns{0}, read_due_ns{0};  ///< of the read that is being made

 private:
  void read(AsideBell& bell);
  void note_books() noexcept;
  template <class Run>
  [[nodiscard]] AsideCall row(DeviceCall which, Run run);

  const std::array<AsideCall, hang_limits.size() - 1> calls;
};

}  // namespace compueye::device
