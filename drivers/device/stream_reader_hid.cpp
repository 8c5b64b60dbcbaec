#include "drivers/device/stream_reader_hid.hpp"

#include <utility>

namespace compueye::device {

StreamReaderHid::StreamReaderHid(const protocol::DeviceDescriptor& descriptor)
    : reports_(descriptor.channels, descriptor.bits) {}

void StreamReaderHid::begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept {
  reports_.begin_stream(config_id, period_ns);
  next_frame_ = reports_.account().produced;
  needs_time_ = true;
}

std::optional<hal::SampleBlock> StreamReaderHid::take() noexcept {
  const auto block = reports_.take();
  if (!block) return block;
  const std::uint64_t incomplete = reports_.counters().incomplete_frames;
  const bool whole = std::exchange(incomplete_, incomplete) == incomplete;
  const bool follows = std::exchange(next_frame_, block->frame + 1) == block->frame;
  needs_time_ = needs_time_ || !block->flags.time_ok || !whole || !follows;
  return block;
}

void StreamReaderHid::set_time(const protocol::Status& status) noexcept {
  if (status.frames == 0) return;
  reports_.set_time(status);
  needs_time_ = false;
}

void StreamReaderHid::add_failures(FailureCounters& failures) const noexcept {
  const protocol::HidCounters& reports = reports_.counters();
  failures[Failure::crc_error] += reports.crc_errors;
  failures[Failure::garbage] += reports.wrong_id + reports.wrong_part;
  failures[Failure::cut_report] += reports.wrong_length;
  failures[Failure::repeated_part] += reports.duplicate_parts;
  failures[Failure::late_part] += reports.late_parts;
  failures[Failure::other_config] += reports.other_config;
  failures[Failure::incomplete_frame] += reports.incomplete_frames;
  failures[Failure::bad_code] += reports.bad_codes;
}

}  // namespace compueye::device
