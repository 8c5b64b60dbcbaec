#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>

namespace compueye::firmware {

/// What the newest picture is worth to whoever looks at it.
enum class PictureAge : std::uint8_t {
  fresh,
  held,  ///< it stays, and is said to be held
  gone,  ///< too old to act upon: it is taken away
};

/// How a run goes: told by its publish thread and by whoever watches its source, read by any. Numbers of one frame may
/// be mixed with those of the next.
class LiveStatus {
 public:
  /// Frames that are kept from the pictures for checks of the eye, and whether one goes on: counted by whoever reads
  /// the source. Both must outlive this; before the first frame.
  void checks_are_counted_by(const std::atomic<std::uint64_t>& frames, const std::atomic<bool>& go_on) noexcept {
    checked_ = &frames;
    checking_ = &go_on;
  }

  /// A frame was published; `frame` is its number, from 0, `age_ns` from the start of its exposure.
  void published(std::uint64_t frame, std::int64_t age_ns, bool late) noexcept;

  /// SampleSource::faults() and recovering().
  void source_is(std::uint64_t faults, bool recovering) noexcept;

  /// The response does not fit: how many times what noise explains the residual is; 0: it does.
  void misfit_is(double times) noexcept { misfit_.store(times, std::memory_order_relaxed); }

  /// So many channels are left out because they do not follow the others.
  void left_out_are(std::uint64_t channels) noexcept { left_out_.store(channels, std::memory_order_relaxed); }

  void picture_is(PictureAge age) noexcept { picture_.store(age, std::memory_order_relaxed); }

  [[nodiscard]] PictureAge picture() const noexcept { return picture_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_.load(std::memory_order_relaxed); }
  [[nodiscard]] double misfit() const noexcept { return misfit_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t faults() const noexcept { return faults_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool recovering() const noexcept { return recovering_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t delivered() const noexcept { return delivered_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t late() const noexcept { return late_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t age_ns() const noexcept { return age_ns_.load(std::memory_order_relaxed); }
  /// Frames up to the last published one that became no picture, whatever the reason, but for those of checks.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  /// Whether frames are kept from the pictures now, for a check.
  [[nodiscard]] bool checking() const noexcept { return checking_ != nullptr && *checking_; }
  /// Times that such were missing between two published ones.
  [[nodiscard]] std::uint64_t gaps() const noexcept { return gaps_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> delivered_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> late_{0};
  std::atomic<std::uint64_t> gaps_{0};
  std::atomic<std::int64_t> age_ns_{0};
  std::atomic<std::uint64_t> faults_{0};
  std::atomic<bool> recovering_{false};
  std::atomic<double> misfit_{0.0};
  std::atomic<std::uint64_t> left_out_{0};
  std::atomic<PictureAge> picture_{PictureAge::fresh};
  const std::atomic<std::uint64_t>* checked_ = nullptr;
  const std::atomic<bool>* checking_ = nullptr;
};

/// A LiveStatus as a line of text, with the rate since about a second ago. One a reader.
class StatusLine {
 public:
  explicit StatusLine(const LiveStatus& status) noexcept : status_(&status) {}

  /// "24.8/s, age 34 ms, 2 dropped in 1 gap, 0 late, 0 faults": into `room`, cut to it; "-/s" within the first second.
  /// While no frame comes "recovering, silent 1.2 s" instead of rate and age, or "checking the eye, silent 1.2 s": from
  /// a second on, and from three times what the frame before took. Nothing before the first frame as long as that is no
  /// silence. A response that does not fit ends it: ", residual 94 x noise". Does not allocate.
  [[nodiscard]] std::string_view print(std::int64_t now_ns, std::span<char> room) noexcept;

 private:
  void count(std::uint64_t delivered, std::int64_t now_ns) noexcept;

  const LiveStatus* status_;
  bool begun_ = false;
  double rate_hz_ = -1.0;  ///< negative: not known yet
  std::int64_t counted_ns_ = 0;
  std::uint64_t counted_ = 0;
  std::uint64_t heard_ = 0;  ///< frames until heard_ns_
  std::int64_t heard_ns_ = 0;
  std::int64_t frame_took_ns_ = 0;
};

}  // namespace compueye::firmware
