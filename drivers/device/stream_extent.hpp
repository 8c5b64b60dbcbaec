#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "drivers/protocol/status.hpp"

namespace compueye::device {

/// How many frames of a stream a device has exposed by a time of the host: for the time when it can no longer be asked.
///
/// Frames are complete one period after the other from START on. The two clocks drift apart, so the estimate follows
/// the arrivals: a frame that comes before its time moves it back, and when the least late of `window` frames that were
/// waited for is later than the least late before, the device is slow and it moves on. It is right to the latency of
/// the transport, so to one frame where that is less than a period; before the first frames, to the delay of START (10
/// ms at most).
class ExposureClock {
 public:
  void begin(std::int64_t start_ns, std::int64_t period_ns) noexcept;
  /// `waited_for`: it came while the host waited; otherwise the host was late and may have found it at any time after.
  void saw_frame(std::uint64_t device_frame, std::int64_t now_ns, bool waited_for) noexcept;
  /// Frames that were complete before `t_ns`.
  [[nodiscard]] std::uint64_t exposed_before(std::int64_t t_ns) const noexcept;

 private:
  static constexpr int window = 64;
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();

  std::int64_t period_ns_ = 1;
  std::int64_t origin_ns_ = 0;  // start of exposure of frame 0
  std::int64_t least_late_ns_ = none, least_in_window_ns_ = none;
  int in_window_ = 0;
};

/// How many frames the device made in one stream, from START to its end: what those that came are held against.
///
/// Asked after the stream has ended, a device that has not started anew knows (STATUS: `frames`, `overruns`). One that
/// has, or that was plugged in again, has forgotten: the frames are then those that ExposureClock gives until it
/// started anew (its clock is 0 there), was stopped or was seen to be gone, whichever was earliest. One that can no
/// longer be asked is taken to have stopped when its stream did. Of one that has started anew more than once nobody
/// knows when it did first: unless it was gone right behind a frame, its last frame is the one that came last. Those
/// numbers are estimates, and so is one that stands for a count of the device that time has no room for.
class StreamExtent {
 public:
  struct Frames {
    std::uint64_t made = 0;
    std::uint64_t overrun = 0;  ///< of them, as far as the device told
    bool estimated = false;     ///< by rate and time: the device did not tell
  };

  /// START was sent; `before` is the last STATUS before it.
  void begin(std::uint32_t config_id, const protocol::Status& before, std::int64_t start_ns,
             std::int64_t period_ns) noexcept;
  /// As ExposureClock::saw_frame().
  void saw_frame(std::uint64_t device_frame, std::int64_t now_ns, bool waited_for) noexcept {
    come_ = device_frame + 1;
    come_ns_ = now_ns;
    clock_.saw_frame(device_frame, now_ns, waited_for);
  }
  /// Frames that have been exposed since the last one that came.
  [[nodiscard]] std::uint64_t unseen(std::int64_t now_ns) const noexcept;
  /// More frames than these the device cannot have exposed: of those that the clock gives, 2 more, those of 100 ms (a
  /// transport that became faster) and 1/16 of the unseen ones (drift).
  [[nodiscard]] std::uint64_t most_exposed(std::int64_t now_ns) const noexcept;
  /// The device was seen to be gone; the first time counts.
  void saw_gone(std::int64_t t_ns) noexcept {
    if (!idle_ && !gone_) gone_ns_ = t_ns;
    gone_ = true;
  }
  /// It was stopped: RESET_PIPES was answered, or the bus was reset.
  void saw_stopped(std::int64_t t_ns) noexcept { stopped_ns_ = std::min(stopped_ns_, t_ns); }
  /// It is not configured any more, so it has started anew, maybe before it was stopped.
  void saw_idle() noexcept { idle_ = true; }
  /// No frame has come since `t_ns`, for whatever reason.
  void saw_quiet(std::int64_t t_ns) noexcept { quiet_ns_ = std::min(quiet_ns_, t_ns); }
  [[nodiscard]] bool is_open() const noexcept { return open_; }

  /// Closes it with what the device says, asked at `now_ns`.
  [[nodiscard]] Frames close(const protocol::Status& status, std::int64_t now_ns) noexcept;
  /// Closes it without asking: with the time at which it was gone or stopped, else quiet, else `now_ns`.
  [[nodiscard]] Frames close(std::int64_t now_ns) noexcept;

 private:
  bool open_ = false;
  bool idle_ = false, gone_ = false;
  std::uint64_t come_ = 0;  // those before the frame after the last that came
  std::int64_t come_ns_ = 0, period_ns_ = 1;
  std::uint32_t config_id_ = 0;
  protocol::Status before_;
  std::int64_t gone_ns_ = 0, stopped_ns_ = 0, quiet_ns_ = 0;
  ExposureClock clock_;
};

}  // namespace compueye::device
