#pragma once

#include "drivers/device/stream_reader.hpp"
#include "drivers/protocol/hid_assembler.hpp"

namespace compueye::device {

/// Frames out of HID input reports, one a chunk. Reports carry no time, so the device is asked for it: at the first
/// report of a stream, and again after a frame without TIME_OK, an incomplete one, or a gap, in which one may have
/// been.
class StreamReaderHid final : public StreamReader {
 public:
  explicit StreamReaderHid(const protocol::DeviceDescriptor& descriptor);

  void begin_run() noexcept override { reports_.begin_run(); }
  void begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept override;
  void push(std::span<const std::byte> chunk) noexcept override { reports_.push(chunk); }
  [[nodiscard]] std::optional<hal::SampleBlock> take() noexcept override;
  void stop(hal::DropReason reason) noexcept override { reports_.stop(reason); }
  void lose(std::uint64_t frames, hal::DropReason reason) noexcept override { reports_.lose(frames, reason); }
  [[nodiscard]] bool needs_time() const noexcept override { return needs_time_; }
  void set_time(const protocol::Status& status) noexcept override;
  [[nodiscard]] const hal::FrameAccount& account() const noexcept override { return reports_.account(); }
  void add_failures(FailureCounters& failures) const noexcept override;

 private:
  protocol::HidAssembler reports_;
  bool needs_time_ = true;
  std::uint64_t next_frame_ = 0;
  std::uint64_t incomplete_ = 0;
};

}  // namespace compueye::device
