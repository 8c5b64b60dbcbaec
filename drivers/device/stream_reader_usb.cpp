#include "drivers/device/stream_reader_usb.hpp"

namespace compueye::device {

StreamReaderUsb::StreamReaderUsb(const protocol::DeviceDescriptor& descriptor)
    : packets_(descriptor.packet_limits()), frames_(descriptor.channels, descriptor.bits) {}

void StreamReaderUsb::begin_run() noexcept {
  packets_.reset();
  before_run_ = packets_.counters();
  frames_.begin_run();
}

void StreamReaderUsb::begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept {
  packets_.reset();
  frames_.begin_stream(config_id, period_ns);
}

std::optional<hal::SampleBlock> StreamReaderUsb::take() noexcept {
  for (;;) {
    if (auto block = frames_.take()) return block;
    const auto packet = packets_.next();
    if (!packet) return std::nullopt;
    frames_.push(*packet);
  }
}

void StreamReaderUsb::add_failures(FailureCounters& failures) const noexcept {
  const protocol::StreamCounters& stream = packets_.counters();
  failures[Failure::crc_error] += stream.crc_errors - before_run_.crc_errors;
  failures[Failure::garbage] += stream.bad_headers - before_run_.bad_headers;
  failures[Failure::resync] += stream.resyncs - before_run_.resyncs;
  const protocol::AssemblerCounters& frames = frames_.counters();
  failures[Failure::missing_packet] += frames_.missing_packets();
  failures[Failure::repeated_part] += frames.duplicate_parts;
  failures[Failure::late_part] += frames.late_parts;
  failures[Failure::other_config] += frames.other_config;
  failures[Failure::incomplete_frame] += frames.incomplete_frames;
  failures[Failure::bad_code] += frames.bad_codes;
}

}  // namespace compueye::device
