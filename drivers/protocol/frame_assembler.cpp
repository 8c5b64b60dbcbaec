#include "drivers/protocol/frame_assembler.hpp"

#include <limits>

namespace compueye::protocol {

void FrameAssembler::begin_run() noexcept {
  builder_.begin_run();
  counters_ = {};
  last_event_.reset();
  begin_stream(0);
}

void FrameAssembler::begin_stream(std::uint32_t config_id, std::int64_t period_ns) noexcept {
  builder_.abandon(hal::DropReason::transport_gap);
  builder_.begin_stream(period_ns);
  config_id_ = config_id;
  frames_ = {};
  counters_.late_in_a_row = 0;
}

void FrameAssembler::flush() noexcept {
  builder_.release();
  if (builder_.is_open()) finish();
}

void FrameAssembler::finish() noexcept {
  if (!builder_.finish()) ++counters_.incomplete_frames;
}

void FrameAssembler::push(const Packet& packet) noexcept {
  builder_.release();
  if (packet.header.config_id != config_id_) {
    ++counters_.other_config;
    return;
  }
  if (packet.header.type != PacketType::data) {
    builder_.sequence().saw_packet(packet);
    return note_other(packet);
  }
  const std::int64_t device_frame = frames_.at(packet.header.frame);
  if (builder_.is_impossible(device_frame)) {
    ++counters_.wrong_number;
    return;
  }
  // What this packet tells about losses concerns the frames behind the open one.
  if (builder_.ends_open(device_frame)) finish();
  builder_.sequence().saw_packet(packet);
  push_data(packet, device_frame);
}

void FrameAssembler::push_data(const Packet& packet, std::int64_t device_frame) noexcept {
  const FrameHeader& header = packet.header;
  if (builder_.is_late(device_frame)) {
    ++counters_.late_parts;
    ++counters_.late_in_a_row;
    return;
  }
  if (header.first_ch + header.n_ch > static_cast<int>(builder_.channels())) return;  // a stream with other limits
  if (!builder_.is_open()) builder_.open(device_frame);
  if (builder_.overlaps(header.first_ch, header.n_ch)) {
    ++counters_.duplicate_parts;
    return;
  }
  frames_.move_to(device_frame);
  counters_.late_in_a_row = 0;
  ++counters_.parts;

  hal::SampleBlock& block = builder_.block();
  constexpr std::uint64_t latest = std::numeric_limits<std::int64_t>::max();
  if (builder_.empty()) {
    block.t_ns = static_cast<std::int64_t>(header.t_ns < latest ? header.t_ns : latest);
    block.config_id = header.config_id;
    block.flags.dark = header.has(packet_flag::dark);
    builder_.conditions() = {header.illum, header.temperature};
  }
  block.flags.overrun = block.flags.overrun || header.has(packet_flag::overrun);
  block.flags.saturated = block.flags.saturated || header.has(packet_flag::sat);
  block.flags.time_ok = block.flags.time_ok && header.has(packet_flag::time_ok) && header.t_ns <= latest;

  const FrameBuilder::Part part = builder_.take_part(header.first_ch, header.n_ch);
  counters_.bad_codes += header.n_ch - unpack(header.format, packet.payload, block.bits, part.codes, part.valid);
  if (builder_.whole() || header.has(packet_flag::eof)) finish();
}

void FrameAssembler::note_other(const Packet& packet) noexcept {
  switch (packet.header.type) {
    case PacketType::event:
      ++counters_.events;
      if (packet.payload.size() >= EventPayload::bytes) {
        last_event_ = load_event(packet.payload.first<EventPayload::bytes>());
      }
      return;
    case PacketType::log:
      ++counters_.logs;
      return;
    default:
      ++counters_.unknown_types;
  }
}

}  // namespace compueye::protocol
