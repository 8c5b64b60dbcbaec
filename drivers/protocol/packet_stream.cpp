#include "drivers/protocol/packet_stream.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"

namespace compueye::protocol {
namespace {

constexpr std::size_t magic_bytes = sizeof packet_magic;

/// Where the magic number starts, or its beginning at the very end; bytes.size() when it is nowhere.
std::size_t find_magic(std::span<const std::byte> bytes) noexcept {
  std::byte magic[magic_bytes];
  store_little(magic, packet_magic);
  std::size_t at = 0;
  while (at < bytes.size()) {
    const void* const first = std::memchr(bytes.data() + at, std::to_integer<int>(magic[0]), bytes.size() - at);
    if (first == nullptr) return bytes.size();
    at = static_cast<std::size_t>(static_cast<const std::byte*>(first) - bytes.data());
    if (std::memcmp(bytes.data() + at, magic, std::min(magic_bytes, bytes.size() - at)) == 0) return at;
    ++at;
  }
  return at;
}

}  // namespace

PacketStream::PacketStream(const PacketLimits& limits)
    : limits_{std::clamp(limits.channels, 1, most_channels),
              std::clamp<std::size_t>(limits.payload_bytes, 1, most_payload_bytes)},
      buffer_(least_packet_bytes + limits_.payload_bytes) {}

void PacketStream::feed(std::span<const std::byte> chunk) noexcept {
  has_more_ = false;
  if (!chunk_.empty()) skip(chunk_.size());
  chunk_ = chunk;
}

void PacketStream::reset() noexcept {
  has_more_ = false;
  if (pending_bytes() > 0) skip(pending_bytes());
  begin_ = end_ = 0;
  chunk_ = {};
}

std::optional<Packet> PacketStream::next(std::size_t& crc_bytes) noexcept {
  FrameHeader header;
  std::size_t needed = 0;
  has_more_ = false;
  // Whether what was no packet may be followed by another look.
  const auto goes_on = [&] {
    crc_bytes -= std::min(crc_bytes, needed);
    has_more_ = crc_bytes == 0;
    return !has_more_;
  };
  while (begin_ < end_) {
    begin_ += skip_to_magic(buffered());
    if (begin_ == end_) break;
    const Found found = look(buffered(), header, needed);
    if (found == Found::incomplete) {
      if (!refill(needed)) return std::nullopt;
    } else if (found == Found::skipped) {
      ++begin_;
      if (!goes_on()) return std::nullopt;
    } else {
      const std::byte* const at = buffer_.data() + begin_;
      begin_ += header.packet_bytes();
      return accept(header, at);
    }
  }
  while (!chunk_.empty()) {
    chunk_ = chunk_.subspan(skip_to_magic(chunk_));
    if (chunk_.empty()) break;
    const Found found = look(chunk_, header, needed);
    if (found == Found::incomplete) {
      keep_rest();
      return std::nullopt;
    }
    if (found == Found::skipped) {
      chunk_ = chunk_.subspan(1);
      if (!goes_on()) return std::nullopt;
      continue;
    }
    const std::byte* const at = chunk_.data();
    chunk_ = chunk_.subspan(header.packet_bytes());
    return accept(header, at);
  }
  return std::nullopt;
}

/// What stands at the start of `bytes`, which begin with the magic number or its beginning. Incomplete: `needed` bytes
/// have to be there to tell. A false packet has its first byte skipped.
PacketStream::Found PacketStream::look(std::span<const std::byte> bytes, FrameHeader& header,
                                       std::size_t& needed) noexcept {
  needed = header_bytes;
  if (bytes.size() < needed) return Found::incomplete;
  header = load_header(bytes.first<header_bytes>());
  if (!plausible(header, limits_)) {
    ++counters_.bad_headers;
    skip(1);
    return Found::skipped;
  }
  needed = header.packet_bytes();
  if (bytes.size() < needed) return Found::incomplete;
  const std::size_t covered = needed - packet_crc_bytes;
  if (crc32c(bytes.first(covered)) != load_little<std::uint32_t>(bytes.data() + covered)) {
    ++counters_.crc_errors;
    skip(1);
    return Found::skipped;
  }
  return Found::packet;
}

/// Brings the buffer up to `needed` bytes out of the chunk; false when the chunk is used up first.
bool PacketStream::refill(std::size_t needed) noexcept {
  if (begin_ + needed > buffer_.size()) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t more = std::min(needed - (end_ - begin_), chunk_.size());
  if (more > 0) std::memcpy(buffer_.data() + end_, chunk_.data(), more);
  end_ += more;
  chunk_ = chunk_.subspan(more);
  return end_ - begin_ == needed;
}

/// The beginning of a packet at the end of a chunk: shorter than the longest packet, so it fits.
void PacketStream::keep_rest() noexcept {
  std::memcpy(buffer_.data(), chunk_.data(), chunk_.size());
  begin_ = 0;
  end_ = chunk_.size();
  chunk_ = {};
}

std::size_t PacketStream::skip_to_magic(std::span<const std::byte> bytes) noexcept {
  const std::size_t before = find_magic(bytes);
  if (before > 0) skip(before);
  return before;
}

void PacketStream::skip(std::size_t bytes) noexcept {
  counters_.skipped_bytes += bytes;
  skipped_since_packet_ += bytes;
}

Packet PacketStream::accept(const FrameHeader& header, const std::byte* at) noexcept {
  ++counters_.packets;
  counters_.packet_bytes += header.packet_bytes();
  if (skipped_since_packet_ > 0) ++counters_.resyncs;
  return {header, {at + header_bytes, header.payload_bytes}, std::exchange(skipped_since_packet_, 0)};
}

}  // namespace compueye::protocol
