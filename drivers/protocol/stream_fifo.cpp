#include "drivers/protocol/stream_fifo.hpp"

#include <algorithm>
#include <cstring>

#include "drivers/protocol/frame_header.hpp"

namespace compueye::protocol {

StreamFifo::StreamFifo(std::size_t bytes) : bytes_(bytes), entries_(bytes / least_packet_bytes + 1) {}

void StreamFifo::push(std::span<const std::byte> packet, std::int64_t available_ns) noexcept {
  if (packet.empty()) return;
  const std::size_t at = (begin_ + used_) % bytes_.size();
  const std::size_t before_end = std::min(packet.size(), bytes_.size() - at);
  std::memcpy(bytes_.data() + at, packet.data(), before_end);
  if (before_end < packet.size()) std::memcpy(bytes_.data(), packet.data() + before_end, packet.size() - before_end);
  used_ += packet.size();
  entries_[(first_ + waiting_++) % entries_.size()] = {packet.size(), available_ns};
}

std::size_t StreamFifo::read(std::int64_t now_ns, std::span<std::byte> into, bool one_packet) noexcept {
  std::size_t done = 0;
  while (waiting_ > 0 && done < into.size()) {
    const Entry& oldest = entries_[first_];
    if (oldest.available_ns > now_ns) break;
    const std::size_t count = std::min(oldest.bytes, into.size() - done);
    const std::size_t before_end = std::min(count, bytes_.size() - begin_);
    std::memcpy(into.data() + done, bytes_.data() + begin_, before_end);
    if (before_end < count) std::memcpy(into.data() + done + before_end, bytes_.data(), count - before_end);
    done += count;
    drop_front(one_packet ? oldest.bytes : count);
    if (one_packet) break;
  }
  return done;
}

std::optional<std::int64_t> StreamFifo::available_ns() const noexcept {
  if (waiting_ == 0) return std::nullopt;
  return entries_[first_].available_ns;
}

void StreamFifo::clear() noexcept {
  begin_ = used_ = first_ = waiting_ = 0;
}

void StreamFifo::cut() noexcept {
  if (waiting_ == 0) return;
  Entry& oldest = entries_[first_];
  oldest.bytes = std::max<std::size_t>(oldest.bytes / 2, 1);
  used_ = oldest.bytes;
  waiting_ = 1;
}

void StreamFifo::drop_front(std::size_t bytes) noexcept {
  begin_ = (begin_ + bytes) % bytes_.size();
  used_ -= bytes;
  Entry& oldest = entries_[first_];
  oldest.bytes -= bytes;
  if (oldest.bytes > 0) return;
  first_ = (first_ + 1) % entries_.size();
  --waiting_;
}

}  // namespace compueye::protocol
