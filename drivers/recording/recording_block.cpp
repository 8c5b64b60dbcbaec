#include "drivers/recording/recording_block.hpp"

#include <algorithm>
#include <cstring>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/little_endian.hpp"

namespace compueye::recording {
namespace {

using protocol::load_little;
using protocol::store_little;

constexpr std::size_t head_crc_at = block_head_bytes - crc_bytes;

// Bits of byte 5 in a frame block.
constexpr unsigned overrun = 1, saturated = 2, dark = 4, time_ok = 8;

std::uint8_t packed(const hal::BlockFlags& flags) noexcept {
  return static_cast<std::uint8_t>((flags.overrun ? overrun : 0U) | (flags.saturated ? saturated : 0U) |
                                   (flags.dark ? dark : 0U) | (flags.time_ok ? time_ok : 0U));
}

hal::BlockFlags unpacked(unsigned bits) noexcept {
  return {(bits & overrun) != 0, (bits & saturated) != 0, (bits & dark) != 0, (bits & time_ok) != 0};
}

bool within_limits(const BlockHead& head) noexcept {
  const RecordedBooks& books = head.books;
  return head.arrival_ns >= 0 && head.arrival_ns <= most_arrival_ns && head.frame <= most_count &&
         books.index <= most_count && books.unrecorded <= most_count && books.estimated <= most_count &&
         std::all_of(books.dropped.begin(), books.dropped.end(), [](std::uint64_t n) { return n <= most_count; });
}

void encode_head(const BlockHead& head, std::size_t length, std::byte* at) noexcept {
  std::memcpy(at, block_magic.data(), block_magic.size());
  at[4] = static_cast<std::byte>(head.kind);
  at[5] =
      head.kind == BlockKind::frame ? static_cast<std::byte>(packed(head.flags)) : static_cast<std::byte>(head.ending);
  store_little(at + 6, std::uint16_t{0});
  store_little(at + 8, static_cast<std::uint32_t>(length));
  store_little(at + 12, head.config_id);
  store_little(at + 16, head.books.index);
  store_little(at + 24, head.kind == BlockKind::frame ? head.frame : head.books.estimated);
  store_little(at + 32, head.t_ns);
  store_little(at + 40, head.arrival_ns);
  store_little(at + 48, head.books.unrecorded);
  for (std::size_t r = 0; r < recorded_reasons; ++r) store_little(at + 56 + 8 * r, head.books.dropped[r]);
  store_little(at + head_crc_at, protocol::crc32c(std::span(at, head_crc_at)));
}

void seal(std::span<std::byte> block) noexcept {
  const std::size_t covered = block.size() - crc_bytes;
  store_little(block.data() + covered, protocol::crc32c(block.first(covered)));
}

}  // namespace

const char* name(Ending ending) noexcept {
  switch (ending) {
    case Ending::stopped:
      return "stopped";
    case Ending::end_of_stream:
      return "end of stream";
    case Ending::source_failed:
      return "source failed";
  }
  return "unknown";
}

bool encode_frame_block(const BlockHead& head, std::span<const std::int32_t> codes, std::span<const std::uint8_t> valid,
                        int bits, std::span<std::byte> to) noexcept {
  if (!within_limits(head) || valid.size() != codes.size() || to.size() != frame_block_bytes(codes.size(), bits)) {
    return false;
  }
  encode_head(head, to.size(), to.data());
  std::byte* at = to.data() + block_head_bytes;
  std::fill_n(at, validity_bytes(codes.size()), std::byte{0});
  for (std::size_t c = 0; c < codes.size(); ++c) {
    if (valid[c] != 0) at[c / 8] |= static_cast<std::byte>(1U << (c % 8));
  }
  at += validity_bytes(codes.size());
  // Or-ed rather than tested one by one: a code outside sets a bit that none may have, be it the sign.
  std::uint32_t all = 0;
  if (code_bytes(bits) == 2) {
    for (const std::int32_t code : codes) {
      all |= static_cast<std::uint32_t>(code);
      store_little(at, static_cast<std::uint16_t>(code));
      at += 2;
    }
  } else {
    for (const std::int32_t code : codes) {
      all |= static_cast<std::uint32_t>(code);
      store_little(at, static_cast<std::uint16_t>(code));
      at[2] = static_cast<std::byte>(static_cast<std::uint32_t>(code) >> 16U);
      at += 3;
    }
  }
  seal(to);
  return all >> static_cast<unsigned>(bits) == 0;
}

bool encode_end_block(const BlockHead& head, std::span<std::byte, end_block_bytes> to) noexcept {
  if (!within_limits(head)) return false;
  encode_head(head, to.size(), to.data());
  seal(to);
  return true;
}

std::optional<BlockHead> decode_head(std::span<const std::byte, block_head_bytes> bytes,
                                     std::size_t frame_bytes) noexcept {
  const std::byte* const at = bytes.data();
  if (std::memcmp(at, block_magic.data(), block_magic.size()) != 0) return std::nullopt;
  if (protocol::crc32c(bytes.first(head_crc_at)) != load_little<std::uint32_t>(at + head_crc_at)) return std::nullopt;
  const auto kind = std::to_integer<unsigned>(at[4]), what = std::to_integer<unsigned>(at[5]);
  const std::size_t length = load_little<std::uint32_t>(at + 8);
  BlockHead head;
  if (kind == static_cast<unsigned>(BlockKind::frame)) {
    if (length != frame_bytes || what > (overrun | saturated | dark | time_ok)) return std::nullopt;
    head.flags = unpacked(what);
  } else if (kind == static_cast<unsigned>(BlockKind::end)) {
    if (length != end_block_bytes || what > static_cast<unsigned>(Ending::source_failed)) return std::nullopt;
    head.kind = BlockKind::end;
    head.ending = static_cast<Ending>(what);
  } else {
    return std::nullopt;
  }
  head.config_id = load_little<std::uint32_t>(at + 12);
  head.books.index = load_little<std::uint64_t>(at + 16);
  (head.kind == BlockKind::frame ? head.frame : head.books.estimated) = load_little<std::uint64_t>(at + 24);
  head.t_ns = load_little<std::int64_t>(at + 32);
  head.arrival_ns = load_little<std::int64_t>(at + 40);
  head.books.unrecorded = load_little<std::uint64_t>(at + 48);
  for (std::size_t r = 0; r < recorded_reasons; ++r) {
    head.books.dropped[r] = load_little<std::uint64_t>(at + 56 + 8 * r);
  }
  if (load_little<std::uint16_t>(at + 6) != 0 || !within_limits(head)) return std::nullopt;
  return head;
}

bool follows(const BlockHead& head, const RecordedBooks& last, std::optional<std::uint64_t> last_frame) noexcept {
  const RecordedBooks& books = head.books;
  if (books.index < last.index || books.unrecorded < last.unrecorded) return false;
  for (std::size_t r = 0; r < recorded_reasons; ++r) {
    if (books.dropped[r] < last.dropped[r]) return false;
  }
  return head.kind == BlockKind::end || !last_frame || head.frame > *last_frame;
}

bool sealed(std::span<const std::byte> block) noexcept {
  const std::size_t covered = block.size() - crc_bytes;
  return protocol::crc32c(block.first(covered)) == load_little<std::uint32_t>(block.data() + covered);
}

bool decode_samples(std::span<const std::byte> block, int bits, std::span<std::int32_t> codes,
                    std::span<std::uint8_t> valid) noexcept {
  const std::byte* at = block.data() + block_head_bytes;
  for (std::size_t c = 0; c < valid.size(); ++c) {
    valid[c] = static_cast<std::uint8_t>(std::to_integer<unsigned>(at[c / 8]) >> (c % 8) & 1U);
  }
  const std::size_t behind = valid.size() % 8;
  if (behind != 0 && std::to_integer<unsigned>(at[valid.size() / 8]) >> behind != 0) return false;
  at += validity_bytes(valid.size());
  std::uint32_t all = 0;
  const bool wide = code_bytes(bits) == 3;
  for (std::int32_t& code : codes) {
    std::uint32_t value = load_little<std::uint16_t>(at);
    if (wide) value |= std::to_integer<std::uint32_t>(at[2]) << 16U;
    all |= value;
    code = static_cast<std::int32_t>(value);
    at += wide ? 3 : 2;
  }
  return all >> static_cast<unsigned>(bits) == 0;
}

}  // namespace compueye::recording
