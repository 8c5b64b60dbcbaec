#pragma once

#include "drivers/device/stream_reader.hpp"
#include "drivers/protocol/frame_assembler.hpp"
#include "drivers/protocol/packet_stream.hpp"

namespace compueye::device {

/// Frames out of a stream of packets.
class StreamReaderUsb final : public StreamReader {
 public:
  explicit StreamReaderUsb(const protocol::DeviceDescriptor& descriptor);

  void begin_run() noexcept override;
  void begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept override;
  void push(std::span<const std::byte> chunk) noexcept override { packets_.feed(chunk); }
  [[nodiscard]] std::optional<hal::SampleBlock> take() noexcept override;
  void stop(hal::DropReason reason) noexcept override { frames_.stop(reason); }
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept override { frames_.lose(frames, reason); }
  [[nodiscard]] const hal::FrameAccount& account() const noexcept override { return frames_.account(); }
  void add_failures(FailureCounters& failures) const noexcept override;

 private:
  protocol::PacketStream packets_;
  protocol::FrameAssembler frames_;
  protocol::StreamCounters before_run_;
};

}  // namespace compueye::device
