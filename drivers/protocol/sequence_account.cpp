#include "drivers/protocol/sequence_account.hpp"

#include <algorithm>
#include <utility>

namespace compueye::protocol {

void SequenceAccount::begin_stream() noexcept {
  stream_base_ = next_frame_;
  device_drops_ = damaged_packets_ = missing_packets_ = 0;
  last_dropped_ = 0;
  next_seq_ = 0;
  seq_ = {};
}

void SequenceAccount::saw_packet(const Packet& packet) noexcept {
  if (packet.skipped_before > 0) {
    // How many packets the skipped bytes were is unknown: as many as would have been as long as this one.
    const std::size_t length = packet.header.packet_bytes();
    damaged_packets_ += packet.skipped_before / length + (packet.skipped_before % length != 0 ? 1 : 0);
  }
  const std::int64_t seq = seq_.at(packet.header.seq);
  if (seq < next_seq_) return;  // a repeated or late one brings no news
  missing_packets_ += static_cast<std::uint64_t>(seq - next_seq_);
  all_missing_packets_ += static_cast<std::uint64_t>(seq - next_seq_);
  next_seq_ = seq + 1;
  seq_.move_to(seq);
  device_drops_ += static_cast<std::uint16_t>(packet.header.dropped - last_dropped_);
  last_dropped_ = packet.header.dropped;
}

FrameGap SequenceAccount::place(std::uint64_t frame) noexcept {
  std::uint64_t missing = frame - next_frame_;
  next_frame_ = frame + 1;
  FrameGap gap;
  gap.overrun = std::min(missing, device_drops_);
  device_drops_ -= gap.overrun;
  missing -= gap.overrun;
  const std::uint64_t damaged = std::exchange(damaged_packets_, 0), lost = std::exchange(missing_packets_, 0);
  gap.corrupt = std::min(missing, damaged);
  missing -= gap.corrupt;
  (damaged == 0 && lost == 0 ? gap.overrun : gap.transport) += missing;
  return gap;
}

void SequenceAccount::deliver(const FrameGap& before) noexcept {
  count(before);
  ++account_.produced;
  ++account_.delivered;
}

void SequenceAccount::drop(const FrameGap& before, hal::DropReason reason) noexcept {
  count(before);
  ++account_.produced;
  ++account_.drops(reason);
}

void SequenceAccount::lose(std::uint64_t frames, hal::DropReason reason) noexcept {
  next_frame_ += frames;
  account_.produced += frames;
  account_.drops(reason) += frames;
}

void SequenceAccount::count(const FrameGap& gap) noexcept {
  account_.produced += gap.total();
  account_.drops(hal::DropReason::device_overrun) += gap.overrun;
  account_.drops(hal::DropReason::corrupt) += gap.corrupt;
  account_.drops(hal::DropReason::transport_gap) += gap.transport;
}

}  // namespace compueye::protocol
