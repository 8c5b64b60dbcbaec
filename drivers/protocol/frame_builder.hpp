#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "drivers/protocol/sequence_account.hpp"
#include "hal/accounting.hpp"
#include "hal/sample_block.hpp"

namespace compueye::protocol {

/// What belongs to a frame beside its samples and a hal::SampleBlock has no room for.
struct FrameConditions {
  std::uint8_t illum = 0;        ///< FrameHeader::illum
  std::int16_t temperature = 0;  ///< 0.01 degrees C
};

/// The frame that is being put together out of parts, and up to two finished ones that wait to be taken. Memory is made
/// at set-up. The samples of a taken block stay valid until the next frame is opened after release().
class FrameBuilder {
 public:
  /// `channels` 1 .. 65535, `bits` 1 .. 24: those of a parsed descriptor.
  FrameBuilder(int channels, int bits);

  void begin_run() noexcept;
  /// `period_ns`: between frames as configured; a time step off what the frame numbers say, by a quarter of a period
  /// and 2 % of a gap, makes flags.time_ok false. 0: only a step that is not forwards does.
  void begin_stream(std::int64_t period_ns) noexcept;
  /// Taken blocks end here. Blocks that were not taken are dropped as superseded.
  void release() noexcept;

  [[nodiscard]] bool is_open() const noexcept { return open_; }
  [[nodiscard]] std::uint64_t frame() const noexcept { return slots_[current_].block.frame; }
  // Frames of the device are counted from its START and unwrapped; a negative number is from before it.
  /// Comes after the open frame, which therefore is over.
  [[nodiscard]] bool ends_open(std::int64_t device_frame) const noexcept;
  /// Has its fate already, or lies before the open frame.
  [[nodiscard]] bool is_late(std::int64_t device_frame) const noexcept;
  /// Frames from this number of the stream on cannot have been exposed yet; until begin_stream(), which knows of none.
  void expect_below(std::uint64_t device_frames) noexcept { frames_below_ = device_frames; }
  [[nodiscard]] bool is_impossible(std::int64_t device_frame) const noexcept {
    return device_frame >= 0 && static_cast<std::uint64_t>(device_frame) >= frames_below_;
  }
  /// Begins a frame that is not late; there is none open.
  void open(std::int64_t device_frame) noexcept;
  /// Whether any of these channels came already.
  [[nodiscard]] bool overlaps(std::size_t first, std::size_t count) const noexcept;
  /// Where a part's codes and their validity go; the range lies within the channels. Counts them as come.
  struct Part {
    std::span<std::int32_t> codes;
    std::span<std::uint8_t> valid;
  };
  [[nodiscard]] Part take_part(std::size_t first, std::size_t count) noexcept;
  [[nodiscard]] bool whole() const noexcept { return slots_[current_].come == channels_; }
  [[nodiscard]] bool empty() const noexcept { return slots_[current_].come == 0; }
  /// t_ns, config_id and flags of the open frame are written here.
  [[nodiscard]] hal::SampleBlock& block() noexcept { return slots_[current_].block; }
  [[nodiscard]] FrameConditions& conditions() noexcept { return slots_[current_].conditions; }
  /// The open frame is over: channels that did not come are invalid. It waits for take(). Returns whether it is whole.
  bool finish() noexcept;
  /// The open frame and those waiting are dropped.
  void abandon(hal::DropReason reason) noexcept;
  /// As abandon(), and so many frames more that will never come.
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept;

  /// The oldest finished frame. Frames lost before it are in the account when it is returned.
  [[nodiscard]] std::optional<hal::SampleBlock> take() noexcept;
  /// Of the block that take() returned last.
  [[nodiscard]] const FrameConditions& taken_conditions() const noexcept { return taken_; }

  [[nodiscard]] SequenceAccount& sequence() noexcept { return sequence_; }
  [[nodiscard]] const SequenceAccount& sequence() const noexcept { return sequence_; }
  [[nodiscard]] std::size_t channels() const noexcept { return channels_; }

 private:
  struct Slot {
    std::vector<std::int32_t> codes;
    std::vector<std::uint8_t> valid;
    std::size_t come = 0;
    FrameGap gap;
    hal::SampleBlock block;
    FrameConditions conditions;
  };

  [[nodiscard]] bool time_fits(const hal::SampleBlock& block) const noexcept;

  std::size_t channels_;
  int bits_;
  std::array<Slot, 2> slots_;
  std::vector<std::uint8_t> come_;  // of the open frame, one a channel
  std::size_t current_ = 0;
  bool open_ = false;
  std::size_t ready_ = 0;  // finished frames not yet taken; the oldest is slot current_ when there are two
  FrameConditions taken_;
  SequenceAccount sequence_;

  std::uint64_t frames_below_ = std::numeric_limits<std::uint64_t>::max();
  std::int64_t period_ns_ = 0;
  std::int64_t last_t_ns_ = 0;
  std::uint64_t last_frame_ = 0;
  bool has_last_ = false;     // in this run: times must grow
  bool same_stream_ = false;  // in this stream: steps must fit the period
};

}  // namespace compueye::protocol
