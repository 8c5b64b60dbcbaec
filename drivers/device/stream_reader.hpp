#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "drivers/device/failure_counters.hpp"
#include "drivers/protocol/bus.hpp"
#include "drivers/protocol/descriptor.hpp"
#include "drivers/protocol/frame_builder.hpp"
#include "drivers/protocol/status.hpp"
#include "hal/accounting.hpp"
#include "hal/sample_block.hpp"

namespace compueye::device {

/// Bytes of the stream in, whole frames out: what packets and reports have in common. Nothing allocates after
/// construction.
///
///   reader.push(chunk, exposed);                 // which must live until has_more() is false
///   while (const auto block = reader.take()) ...
class StreamReader {
 public:
  StreamReader() = default;
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;
  virtual ~StreamReader() = default;

  /// Frame numbers, account and failures restart at 0.
  virtual void begin_run() noexcept = 0;
  /// The device was started with configuration `config_id`; frame numbers go on.
  virtual void begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept = 0;
  /// How far ahead of the last frame that came a number can be told: half of where it goes round.
  [[nodiscard]] virtual std::uint64_t most_ahead() const noexcept = 0;
  /// `exposed`: as many frames as the device can have exposed in this stream; none of a higher number is taken.
  virtual void push(std::span<const std::byte> chunk, std::uint64_t exposed) noexcept = 0;
  /// The next frame; valid until the next call of anything.
  [[nodiscard]] virtual std::optional<hal::SampleBlock> take() noexcept = 0;
  /// take() returned nothing because that was enough work for one call: there is more to look at in the chunk.
  [[nodiscard]] virtual bool has_more() const noexcept { return false; }
  /// Drops what is in hand as `reason`.
  virtual void stop(hal::DropReason reason) noexcept = 0;
  /// Counts frames that will never come.
  virtual void lose(std::uint64_t frames, hal::DropReason reason) noexcept = 0;

  /// Whether the times of frames need a STATUS of this stream, given to set_time().
  [[nodiscard]] virtual bool needs_time() const noexcept { return false; }
  virtual void set_time(const protocol::Status&) noexcept {}

  [[nodiscard]] virtual const hal::FrameAccount& account() const noexcept = 0;
  /// Adds what was wrong with bytes and frames since begin_run().
  virtual void add_failures(FailureCounters& failures) const noexcept = 0;
};

[[nodiscard]] std::unique_ptr<StreamReader> make_stream_reader(protocol::Framing framing,
                                                               const protocol::DeviceDescriptor& descriptor);

}  // namespace compueye::device
