#include "drivers/protocol/hid_assembler.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "drivers/protocol/sample_format.hpp"

namespace compueye::protocol {

HidAssembler::HidAssembler(int channels, int bits)
    : builder_(std::clamp(channels, 1, hid_most_channels), std::clamp(bits, 1, hid_bits)),
      parts_(hid_parts(static_cast<int>(builder_.channels()))) {}

void HidAssembler::begin_run() noexcept {
  builder_.begin_run();
  counters_ = {};
  begin_stream(0, 0);
}

void HidAssembler::begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept {
  builder_.abandon(hal::DropReason::transport_gap);
  // Times are computed here, so they are not held against the period.
  builder_.begin_stream(0);
  config_id_ = config_id;
  period_ns_ = period_ns;
  frames_ = {};
  has_time_ = false;
  time_frame_ = time_ns_ = 0;
  counters_.late_in_a_row = 0;
}

void HidAssembler::set_time(const Status& status) noexcept {
  constexpr std::uint64_t latest = std::numeric_limits<std::int64_t>::max();
  if (status.frames == 0 || status.last_t_ns > latest) return;
  // STATUS counts modulo 2^32: the frame near the last one that came.
  time_frame_ = frames_.at(status.frames - 1);
  time_ns_ = static_cast<std::int64_t>(status.last_t_ns);
  has_time_ = true;
}

void HidAssembler::flush() noexcept {
  builder_.release();
  if (builder_.is_open()) finish();
}

void HidAssembler::finish() noexcept {
  if (!builder_.finish()) ++counters_.incomplete_frames;
}

bool HidAssembler::usable(const ParsedHidReport& parsed) noexcept {
  switch (parsed.fault) {
    case HidFault::none:
      break;
    case HidFault::wrong_length:
      ++counters_.wrong_length;
      builder_.sequence().saw_damage(1);
      return false;
    case HidFault::wrong_id:
      ++counters_.wrong_id;
      return false;
    case HidFault::wrong_crc:
      ++counters_.crc_errors;
      builder_.sequence().saw_damage(1);
      return false;
    case HidFault::wrong_part:
      ++counters_.wrong_part;
      return false;
  }
  if (parsed.report.parts != parts_) {
    ++counters_.wrong_part;
    return false;
  }
  if (parsed.report.config_tag() != (config_id_ & 0xFU)) {
    ++counters_.other_config;
    return false;
  }
  return true;
}

void HidAssembler::push(std::span<const std::byte> bytes) noexcept {
  builder_.release();
  const ParsedHidReport parsed = parse_hid_report(bytes);
  if (!usable(parsed)) return;
  const std::int64_t device_frame = frames_.at(parsed.report.frame);
  if (builder_.is_impossible(device_frame)) {
    ++counters_.wrong_number;
    return;
  }
  if (builder_.ends_open(device_frame)) finish();
  push_part(parsed.report, device_frame);
}

void HidAssembler::push_part(const HidReport& report, std::int64_t device_frame) noexcept {
  if (builder_.is_late(device_frame)) {
    ++counters_.late_parts;
    ++counters_.late_in_a_row;
    return;
  }
  if (!builder_.is_open()) {
    SequenceAccount& sequence = builder_.sequence();
    const std::uint64_t missing = sequence.run_frame(static_cast<std::uint64_t>(device_frame)) - sequence.next_frame();
    after_gap_ = missing > 0;
    if (report.has(hid_flag::overrun)) {
      sequence.saw_device_drops(missing);
    } else {
      sequence.saw_missing_packets(missing);
    }
    builder_.open(device_frame);
  }
  const std::size_t first = std::size_t{report.part} * hid_channels_per_report;
  const std::size_t count = std::min<std::size_t>(hid_channels_per_report, builder_.channels() - first);
  if (builder_.overlaps(first, count)) {
    ++counters_.duplicate_parts;
    return;
  }
  frames_.move_to(device_frame);
  counters_.late_in_a_row = 0;
  ++counters_.parts;
  hal::SampleBlock& block = builder_.block();
  if (builder_.empty()) {
    set_block_time(device_frame);
    block.config_id = config_id_;
    block.flags.dark = report.has(hid_flag::dark);
  }
  block.flags.overrun = block.flags.overrun || report.has(hid_flag::overrun);
  block.flags.saturated = block.flags.saturated || report.has(hid_flag::sat);
  block.flags.time_ok = block.flags.time_ok && report.has(hid_flag::time_ok);
  const FrameBuilder::Part part = builder_.take_part(first, count);
  counters_.bad_codes += count - unpack(SampleFormat::u12, report.payload.first(packed_bytes(SampleFormat::u12, count)),
                                        block.bits, part.codes, part.valid);
  if (builder_.whole()) finish();
}

void HidAssembler::set_block_time(std::int64_t device_frame) noexcept {
  hal::SampleBlock& block = builder_.block();
  std::int64_t since = 0;
  const bool fits = !__builtin_mul_overflow(device_frame - time_frame_, period_ns_, &since) &&
                    !__builtin_add_overflow(time_ns_, since, &block.t_ns);
  if (!fits) block.t_ns = 0;
  block.flags.time_ok = fits && has_time_ && !after_gap_;
}

}  // namespace compueye::protocol
