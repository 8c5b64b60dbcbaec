// The frames of protocol::DeviceEmulator.

#include <algorithm>
#include <string_view>

#include "drivers/protocol/device_emulator.hpp"
#include "drivers/protocol/packet_encoder.hpp"

namespace compueye::protocol {
namespace {

constexpr std::string_view greeting = "streaming";

}  // namespace

void DeviceEmulator::expose(std::int64_t ready_ns) {
  for (auto& scheduled : faults_) {
    if (scheduled.begun || !scheduled.fault.at_frame || *scheduled.fault.at_frame > frame_) continue;
    scheduled.begun = true;
    begin(scheduled.fault, ready_ns);
    // A device that has started anew exposes its frames at other times.
    if (state_ != DeviceState::streaming || frame_ready_ns() != ready_ns) return;
  }
  const std::uint64_t frame = frame_++;
  const std::int64_t start_ns = exposure_start_ns(frame);
  last_t_ns_ = clock_ns(start_ns);
  ++truth_.frames;
  if (stream_config_id_ == 0) ++truth_.frames_unasked;
  const bool forced = now_wrong_.frames_to_overrun > 0;
  if (forced) --now_wrong_.frames_to_overrun;
  if (forced || !frame_fits()) {
    ++dropped_;
    ++truth_.frames_overrun;
    overrun_pending_ = true;
    return;
  }
  generator_(EmulatedExposure{frame, start_ns, configuration_.exposure_ns, levels_}, codes_);

  if (settings_.bus->framing == Framing::reports) {
    send_reports(ready_ns, start_ns);
  } else {
    send_packets(ready_ns, frame, start_ns);
  }
  overrun_pending_ = false;
  clock_was_set_ = false;
}

/// Nobody reads, so every frame that is ready before `t_ns` fares like the last one: a day of it takes no longer than a
/// frame.
void DeviceEmulator::overrun_until(std::int64_t t_ns) noexcept {
  const auto waits_for_a_frame = [](const Scripted& each) { return !each.begun && each.fault.at_frame; };
  if (state_ != DeviceState::streaming || now_wrong_.frames_to_overrun > 0 || frame_ready_ns() >= t_ns ||
      frame_fits() || std::any_of(faults_.begin(), faults_.end(), waits_for_a_frame)) {
    return;
  }
  const auto frames = static_cast<std::uint64_t>((t_ns - frame_ready_ns() - 1) / period_ns_ + 1);
  frame_ += frames;
  last_t_ns_ = clock_ns(exposure_start_ns(frame_ - 1));
  dropped_ += static_cast<std::uint32_t>(frames);
  overrun_pending_ = true;
  truth_.frames += frames;
  truth_.frames_overrun += frames;
  if (stream_config_id_ == 0) truth_.frames_unasked += frames;
}

void DeviceEmulator::send_packets(std::int64_t ready_ns, std::uint64_t frame, std::int64_t start_ns) {
  FrameHeader header;
  header.version = descriptor_.version;
  header.frame = static_cast<std::uint32_t>(frame);
  header.t_ns = clock_ns(start_ns);
  header.config_id = stream_config_id_;
  header.illum = illum(start_ns);
  header.temperature = 2500;
  header.dropped = static_cast<std::uint16_t>(dropped_);
  if (overrun_pending_) header.flags |= packet_flag::overrun;
  if (dark(start_ns)) header.flags |= packet_flag::dark;
  if (!clock_was_set_) header.flags |= packet_flag::time_ok;
  if (settings_.events) send_events(ready_ns, header);
  if (header.illum != illumination_changing) settling_ = false;
  header.format = configuration_.format;
  const auto full_scale = static_cast<std::int32_t>((1U << static_cast<unsigned>(descriptor_.bits)) - 1U);
  const auto step = static_cast<std::size_t>(channels_in(header.format, descriptor_.most_payload));
  const std::uint16_t flags = header.flags;
  for (std::size_t first = 0; first < codes_.size(); first += step) {
    const auto part = std::span<const std::int32_t>(codes_).subspan(first, std::min(step, codes_.size() - first));
    header.flags = flags;
    if (first == 0) header.flags |= packet_flag::sof;
    if (first + part.size() == codes_.size()) header.flags |= packet_flag::eof;
    if (std::find(part.begin(), part.end(), full_scale) != part.end()) header.flags |= packet_flag::sat;
    header.first_ch = static_cast<std::uint16_t>(first);
    header.seq = seq_++;
    const std::size_t bytes = encode_data(header, part, descriptor_.bits, packet_);
    give_to_link(ready_ns, std::span(packet_).first(bytes));
  }
}

void DeviceEmulator::send_events(std::int64_t ready_ns, const FrameHeader& header) {
  if (header.frame == 0) send_event(ready_ns, header, PacketType::log, std::as_bytes(std::span(greeting)));
  std::byte event[EventPayload::bytes];
  if (overrun_pending_) {
    store(EventPayload{EventPayload::overrun_began, dropped_}, event);
    send_event(ready_ns, header, PacketType::event, event);
  }
  if (settling_ && header.illum != illumination_changing) {
    store(EventPayload{EventPayload::illumination_settled, header.illum}, event);
    send_event(ready_ns, header, PacketType::event, event);
  }
  if (clock_was_set_) {
    store(EventPayload{EventPayload::clock_set, 0}, event);
    send_event(ready_ns, header, PacketType::event, event);
  }
}

void DeviceEmulator::send_event(std::int64_t ready_ns, FrameHeader header, PacketType type,
                                std::span<const std::byte> payload) {
  header.type = type;
  header.flags &= packet_flag::time_ok;
  header.seq = seq_++;
  const std::size_t bytes = encode_packet(header, payload, packet_);
  give_to_link(ready_ns, std::span(packet_).first(bytes));
}

void DeviceEmulator::send_reports(std::int64_t ready_ns, std::int64_t start_ns) {
  unsigned all_flags = (stream_config_id_ & 0xFU) << hid_flag::config_tag_shift;
  if (overrun_pending_) all_flags |= hid_flag::overrun;
  if (dark(start_ns)) all_flags |= hid_flag::dark;
  if (!clock_was_set_) all_flags |= hid_flag::time_ok;
  const auto flags = static_cast<std::uint8_t>(all_flags);
  HidReport report;
  report.frame = static_cast<std::uint16_t>(frame_ - 1);
  report.parts = static_cast<std::uint8_t>(hid_parts(descriptor_.channels));
  const auto full_scale = static_cast<std::int32_t>((1U << static_cast<unsigned>(descriptor_.bits)) - 1U);
  for (std::size_t first = 0; first < codes_.size(); first += hid_channels_per_report, ++report.part) {
    const auto part = std::span<const std::int32_t>(codes_).subspan(
        first, std::min<std::size_t>(hid_channels_per_report, codes_.size() - first));
    report.flags = flags;
    if (std::find(part.begin(), part.end(), full_scale) != part.end()) report.flags |= hid_flag::sat;
    encode_hid_report(report, part, std::span(packet_).first<hid_report_bytes>());
    ++seq_;
    give_to_link(ready_ns, std::span(packet_).first(hid_report_bytes));
  }
}

void DeviceEmulator::give_to_link(std::int64_t ready_ns, std::span<std::byte> packet) noexcept {
  ++truth_.packets;
  const double seconds = static_cast<double>(packet.size()) / settings_.link_bytes_per_s;
  link_free_ns_ = std::max(link_free_ns_, ready_ns) + static_cast<std::int64_t>(seconds * 1e9);
  if (now_wrong_.lost_packets > 0) {
    --now_wrong_.lost_packets;
    ++truth_.packets_lost;
    return;
  }
  if (now_wrong_.bit_errors > 0) {
    --now_wrong_.bit_errors;
    ++truth_.packets_damaged;
    const auto bit = static_cast<std::size_t>(random_() % (8 * packet.size()));
    packet[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
  }
  if (now_wrong_.short_packets > 0) {
    --now_wrong_.short_packets;
    ++truth_.packets_damaged;
    packet = packet.first(packet.size() / 2);
  }
  int copies = 1;
  if (now_wrong_.duplicates > 0) {
    --now_wrong_.duplicates;
    copies = 2;
  }
  for (; copies > 0 && fifo_.fits(packet.size(), 1); --copies) fifo_.push(packet, link_free_ns_);
}

bool DeviceEmulator::frame_fits() const noexcept {
  const FrameSize frame = frame_size(*settings_.bus, descriptor_, configuration_.format);
  // Up to four log and event packets go with it.
  constexpr std::size_t most_others = 4, other_bytes = least_packet_bytes + 16;
  const std::size_t others = settings_.events ? most_others : 0;
  return fifo_.fits(frame.bytes + others * other_bytes, frame.packets + others);
}

bool DeviceEmulator::dark(std::int64_t start_ns) const noexcept {
  return !levels_.empty() && start_ns >= settled_ns_ &&
         std::all_of(levels_.begin(), levels_.end(), [](std::uint16_t level) { return level == 0; });
}

std::uint8_t DeviceEmulator::illum(std::int64_t start_ns) const noexcept {
  return start_ns >= settled_ns_ ? illumination_.tag : illumination_changing;
}

}  // namespace compueye::protocol
