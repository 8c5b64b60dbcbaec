#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/protocol/packet_stream.hpp"
#include "hal/accounting.hpp"

namespace compueye::protocol {

/// A counter of `T` that goes round (frame, seq), as 64 bits. A value up to half the range ahead of the last one lies
/// ahead, any other behind.
template <class T>
class Unwrapped {
 public:
  /// Where `value` lies, which may count further than the counter; negative when it is from before the counter's start.
  /// Does not move the counter.
  template <class U>
  [[nodiscard]] std::int64_t at(U value) const noexcept {
    static_assert(sizeof(U) >= sizeof(T));
    using Signed = std::make_signed_t<U>;
    return last_ + static_cast<Signed>(static_cast<U>(value - static_cast<U>(last_)));
  }
  void move_to(std::int64_t value) noexcept { last_ = value; }

 private:
  std::int64_t last_ = 0;
};

/// Frames missing before a frame, by where they went.
struct FrameGap {
  std::uint64_t overrun = 0;
  std::uint64_t corrupt = 0;
  std::uint64_t transport = 0;
  [[nodiscard]] std::uint64_t total() const noexcept { return overrun + corrupt + transport; }
};

/// Gives every frame number exactly one fate: produced = delivered + sum(dropped). Frame numbers here are those of the
/// run: 64 bits, from 0 at begin_run(), going on over a new START of the device.
///
/// Why frames are missing is judged by what was seen since the frame before: as many as the device's `dropped` counter
/// grew are device_overrun; of the rest as many as damaged packets came in between are corrupt; what remains is
/// transport_gap, unless no packet is missing either (then the device itself left the frames out: device_overrun).
class SequenceAccount {
 public:
  void begin_run() noexcept { *this = {}; }
  /// The device has been started anew: what was seen of its counters is void, its frame 0 is the run's next frame.
  void begin_stream() noexcept;

  // What was seen since the last frame was placed.
  void saw_packet(const Packet& packet) noexcept;  ///< any type, in the order received
  void saw_device_drops(std::uint64_t frames) noexcept { device_drops_ += frames; }
  void saw_damage(std::uint64_t packets) noexcept { damaged_packets_ += packets; }
  void saw_missing_packets(std::uint64_t packets) noexcept { missing_packets_ += packets; }

  /// The run's number of the device's frame `device_frame` (unwrapped, from its START).
  [[nodiscard]] std::uint64_t run_frame(std::uint64_t device_frame) const noexcept {
    return stream_base_ + device_frame;
  }
  /// Lowest frame number without a fate.
  [[nodiscard]] std::uint64_t next_frame() const noexcept { return next_frame_; }

  /// Frame `frame` >= next_frame() arrived: explains those before it and moves next_frame() behind it. The counts enter
  /// the account with deliver() or drop().
  [[nodiscard]] FrameGap place(std::uint64_t frame) noexcept;
  void deliver(const FrameGap& before) noexcept;
  void drop(const FrameGap& before, hal::DropReason reason) noexcept;
  /// `frames` more that will never come, for example those of an outage.
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept;

  [[nodiscard]] const hal::FrameAccount& account() const noexcept { return account_; }
  [[nodiscard]] std::uint64_t missing_packets() const noexcept { return all_missing_packets_; }

 private:
  void count(const FrameGap& gap) noexcept;

  hal::FrameAccount account_;
  std::uint64_t next_frame_ = 0;
  std::uint64_t stream_base_ = 0;

  std::uint64_t device_drops_ = 0;
  std::uint64_t damaged_packets_ = 0;
  std::uint64_t missing_packets_ = 0;
  std::uint64_t all_missing_packets_ = 0;
  std::uint16_t last_dropped_ = 0;
  std::int64_t next_seq_ = 0;
  Unwrapped<std::uint32_t> seq_;
};

}  // namespace compueye::protocol
