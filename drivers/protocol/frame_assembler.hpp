#pragma once

#include <cstdint>
#include <optional>

#include "drivers/protocol/frame_builder.hpp"
#include "drivers/protocol/packet_encoder.hpp"
#include "drivers/protocol/packet_stream.hpp"
#include "hal/accounting.hpp"
#include "hal/sample_block.hpp"

namespace compueye::protocol {

struct AssemblerCounters {
  std::uint64_t parts = 0;              ///< data packets whose samples were used
  std::uint64_t duplicate_parts = 0;    ///< channels that had come already
  std::uint64_t late_parts = 0;         ///< of a frame whose fate was settled
  std::uint64_t late_in_a_row = 0;      ///< late since the last used part; growing: the device may have started anew
  std::uint64_t other_config = 0;       ///< packets of another configuration: left over, or of a rebooted device
  std::uint64_t events = 0;             ///< event packets
  std::uint64_t logs = 0;               ///< log packets
  std::uint64_t unknown_types = 0;      ///< packets of a newer minor version
  std::uint64_t incomplete_frames = 0;  ///< finished with channels missing
  std::uint64_t bad_codes = 0;          ///< codes beyond the depth, made invalid
  std::uint64_t wrong_number = 0;       ///< parts of frames that cannot have been exposed yet
};

/// Packets in, whole frames out. A frame may come in several packets (first_ch, n_ch) in any order; it is finished when
/// all channels are there, at its EOF packet, or when a packet of a later frame comes, whichever is first. Missing
/// channels get valid = 0. Frame and sequence numbers are unwrapped to 64 bits; every frame number gets one fate.
///
///   assembler.begin_run(); assembler.begin_stream(config_id, period_ns);      // after every START
///   assembler.push(packet);
///   while (const auto block = assembler.take()) ...
///
/// Nothing allocates after construction.
class FrameAssembler {
 public:
  /// `channels` and `bits` of the descriptor.
  FrameAssembler(int channels, int bits) : builder_(channels, bits) {}

  /// Frame numbers and account restart at 0.
  void begin_run() noexcept;
  /// The device was started with configuration `config_id`: its counters are at 0 and only packets with this id are
  /// used. Frame numbers go on behind those of the stream before. `period_ns` as in FrameBuilder::begin_stream().
  void begin_stream(std::uint32_t config_id, std::int64_t period_ns = 0) noexcept;

  /// As FrameBuilder::expect_below().
  void expect_below(std::uint64_t device_frames) noexcept { builder_.expect_below(device_frames); }

  /// Takes a packet's samples. Blocks returned by take() end here.
  void push(const Packet& packet) noexcept;
  /// The next finished frame, up to two a push. Valid until the next push(), flush(), stop() or begin.
  [[nodiscard]] std::optional<hal::SampleBlock> take() noexcept { return builder_.take(); }
  /// Finishes a frame that waits for more parts, because none will come (a time-out, an end of stream).
  void flush() noexcept;
  /// Drops what is in hand as `reason`.
  void stop(hal::DropReason reason = hal::DropReason::stopped) noexcept { builder_.abandon(reason); }
  /// Counts frames that will never come, for example those of an outage; they have numbers.
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept { builder_.lose(frames, reason); }

  [[nodiscard]] const hal::FrameAccount& account() const noexcept { return builder_.sequence().account(); }
  [[nodiscard]] const AssemblerCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::uint64_t missing_packets() const noexcept { return builder_.sequence().missing_packets(); }
  /// Light and temperature of the block that take() returned last.
  [[nodiscard]] const FrameConditions& conditions() const noexcept { return builder_.taken_conditions(); }
  [[nodiscard]] const std::optional<EventPayload>& last_event() const noexcept { return last_event_; }

 private:
  void push_data(const Packet& packet, std::int64_t device_frame) noexcept;
  void note_other(const Packet& packet) noexcept;
  void finish() noexcept;

  FrameBuilder builder_;
  std::uint32_t config_id_ = 0;
  Unwrapped<std::uint32_t> frames_;
  AssemblerCounters counters_;
  std::optional<EventPayload> last_event_;
};

}  // namespace compueye::protocol
