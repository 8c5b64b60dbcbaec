#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "drivers/protocol/frame_header.hpp"

namespace compueye::protocol {

/// A whole packet whose CRC is right. The payload lies in the chunk that was fed or in the stream's buffer, and is
/// valid until the next call of PacketStream::next(), feed() or reset().
struct Packet {
  FrameHeader header;
  std::span<const std::byte> payload;
  std::size_t skipped_before = 0;  ///< bytes thrown away between the packet before and this one
};

/// fed = bytes of accepted packets + skipped_bytes + PacketStream::pending_bytes(), always.
struct StreamCounters {
  std::uint64_t packets = 0;
  std::uint64_t packet_bytes = 0;
  std::uint64_t skipped_bytes = 0;
  std::uint64_t crc_errors = 0;   ///< headers that made sense in front of a wrong CRC
  std::uint64_t bad_headers = 0;  ///< magic numbers in front of a header that made none
  std::uint64_t resyncs = 0;      ///< times that a good packet was found again after bytes had to be skipped
};

/// Finds packets in a byte stream that comes in chunks of any size and may be damaged anywhere: by magic number,
/// plausible header and CRC. After damage it goes on one byte further, so that a true packet is never lost inside a
/// false one.
///
/// Packets that lie whole in a chunk are returned in place, without a copy; one that spans chunks is put together in a
/// buffer of the longest packet, made at set-up. Nothing allocates afterwards. An accepted false packet would need a
/// CRC-32C to match by chance. Work is bounded: each byte that is skipped costs at most one CRC of the longest packet.
/// Who has less time than that looks on in pieces.
///
///   stream.feed(chunk);
///   while (const auto packet = stream.next()) ...
class PacketStream {
 public:
  explicit PacketStream(const PacketLimits& limits = {});

  /// Hands over the next chunk, which must live until next() has returned nothing. What of the chunk before was not
  /// asked for until then counts as skipped.
  void feed(std::span<const std::byte> chunk) noexcept;
  /// The next packet, or nothing: feed more.
  [[nodiscard]] std::optional<Packet> next() noexcept {
    std::size_t no_limit = std::numeric_limits<std::size_t>::max();
    return next(no_limit);
  }
  /// As above, until the CRCs of what was no packet have covered `crc_bytes`, which what they covered is taken off.
  [[nodiscard]] std::optional<Packet> next(std::size_t& crc_bytes) noexcept;
  /// next() returned nothing because of its limit: call it again, and do not feed.
  [[nodiscard]] bool has_more() const noexcept { return has_more_; }
  /// Forgets a half-received packet (counted as skipped): what follows is a new stream. Counters go on.
  void reset() noexcept;

  [[nodiscard]] const StreamCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] std::size_t pending_bytes() const noexcept { return end_ - begin_ + chunk_.size(); }
  [[nodiscard]] const PacketLimits& limits() const noexcept { return limits_; }

 private:
  enum class Found { packet, incomplete, skipped };

  [[nodiscard]] std::span<const std::byte> buffered() const noexcept {
    return std::span<const std::byte>(buffer_).subspan(begin_, end_ - begin_);
  }
  Found look(std::span<const std::byte> bytes, FrameHeader& header, std::size_t& needed) noexcept;
  [[nodiscard]] bool refill(std::size_t needed) noexcept;
  void keep_rest() noexcept;
  std::size_t skip_to_magic(std::span<const std::byte> bytes) noexcept;
  void skip(std::size_t bytes) noexcept;
  Packet accept(const FrameHeader& header, const std::byte* at) noexcept;

  PacketLimits limits_;
  std::vector<std::byte> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // of what the buffer holds; not empty: the stream goes on there
  std::span<const std::byte> chunk_;
  std::size_t skipped_since_packet_ = 0;
  bool has_more_ = false;
  StreamCounters counters_;
};

}  // namespace compueye::protocol
