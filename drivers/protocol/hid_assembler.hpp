#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/protocol/frame_builder.hpp"
#include "drivers/protocol/hid_report.hpp"
#include "drivers/protocol/status.hpp"
#include "hal/accounting.hpp"
#include "hal/sample_block.hpp"

namespace compueye::protocol {

struct HidCounters {
  std::uint64_t parts = 0;         ///< reports whose samples were used
  std::uint64_t wrong_length = 0;  ///< not 64 bytes
  std::uint64_t wrong_id = 0;      ///< not an input report of samples
  std::uint64_t crc_errors = 0;
  std::uint64_t wrong_part = 0;  ///< part or parts that this device cannot have
  std::uint64_t duplicate_parts = 0;
  std::uint64_t late_parts = 0;         ///< of a frame whose fate was settled
  std::uint64_t late_in_a_row = 0;      ///< growing: the device may have started anew
  std::uint64_t other_config = 0;       ///< the tag of another configuration
  std::uint64_t incomplete_frames = 0;  ///< finished with channels missing
  std::uint64_t bad_codes = 0;          ///< codes beyond the depth, made invalid
  std::uint64_t wrong_number = 0;       ///< parts of frames that cannot have been exposed yet
};

/// HID input reports in, whole frames out: the counterpart of FrameAssembler, used the same way. Reports carry neither
/// time nor a sequence number. Times follow from set_time(), and are doubtful behind a gap, in which the clock may have
/// been set; missing frames are device_overrun when the frame after
/// them says so, corrupt as far as damaged reports came in between, transport_gap otherwise. A frame is finished when
/// all its parts are there or a part of a later frame comes.
///
/// Nothing allocates after construction.
class HidAssembler {
 public:
  /// `channels` 1 .. hid_most_channels, `bits` 1 .. 12: those of the descriptor.
  HidAssembler(int channels, int bits);

  void begin_run() noexcept;
  /// The device was started with configuration `config_id` and counts frames from 0; a frame every `period_ns`.
  void begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept;
  /// Places the device's frames on its clock, from a STATUS of this stream. Until the first call, and when the device
  /// has made no frame yet, times count from frame 0 at 0 ns and flags.time_ok is false.
  void set_time(const Status& status) noexcept;

  /// As FrameBuilder::expect_below().
  void expect_below(std::uint64_t device_frames) noexcept { builder_.expect_below(device_frames); }

  /// Takes one report as read(): exactly 64 bytes, its id first. Blocks returned by take() end here.
  void push(std::span<const std::byte> bytes) noexcept;
  [[nodiscard]] std::optional<hal::SampleBlock> take() noexcept { return builder_.take(); }
  void flush() noexcept;
  void stop(hal::DropReason reason = hal::DropReason::stopped) noexcept { builder_.abandon(reason); }
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept { builder_.lose(frames, reason); }

  [[nodiscard]] const hal::FrameAccount& account() const noexcept { return builder_.sequence().account(); }
  [[nodiscard]] const HidCounters& counters() const noexcept { return counters_; }

 private:
  [[nodiscard]] bool usable(const ParsedHidReport& parsed) noexcept;
  void push_part(const HidReport& report, std::int64_t device_frame) noexcept;
  void set_block_time(std::int64_t device_frame) noexcept;
  void finish() noexcept;

  FrameBuilder builder_;
  int parts_;
  std::uint32_t config_id_ = 0;
  std::int64_t period_ns_ = 0;
  Unwrapped<std::uint16_t> frames_;
  bool has_time_ = false;
  bool after_gap_ = false;  // of the open frame
  std::int64_t time_frame_ = 0, time_ns_ = 0;
  HidCounters counters_;
};

}  // namespace compueye::protocol
