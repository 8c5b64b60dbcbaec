#include "drivers/protocol/cobs.hpp"

#include <algorithm>
#include <cstring>

namespace compueye::protocol {

std::size_t cobs_encode(std::span<const std::byte> data, std::span<std::byte> into) noexcept {
  if (into.size() < cobs_bytes(data.size())) return 0;
  std::size_t code_at = 0, out = 1;
  std::uint8_t code = 1;
  const auto close_block = [&] {
    into[code_at] = static_cast<std::byte>(code);
    code_at = out++;
    code = 1;
  };
  for (const std::byte byte : data) {
    if (code == 0xFF) close_block();
    if (byte == std::byte{0}) {
      close_block();
    } else {
      into[out++] = byte;
      ++code;
    }
  }
  into[code_at] = static_cast<std::byte>(code);
  return out;
}

std::optional<std::size_t> cobs_decode(std::span<const std::byte> encoded, std::span<std::byte> into) noexcept {
  if (encoded.empty()) return std::nullopt;
  std::size_t out = 0;
  for (std::size_t at = 0; at < encoded.size();) {
    const auto code = std::to_integer<std::size_t>(encoded[at]);
    const std::size_t count = code - 1;
    if (code == 0 || count > encoded.size() - at - 1 || count > into.size() - out) return std::nullopt;
    for (std::size_t k = 0; k < count; ++k) {
      const std::byte b = encoded[at + 1 + k];
      if (b == std::byte{0}) return std::nullopt;
      into[out++] = b;
    }
    at += code;
    if (code == 0xFF || at == encoded.size()) continue;
    if (out == into.size()) return std::nullopt;
    into[out++] = std::byte{0};
  }
  return out;
}

CobsDecoder::CobsDecoder(std::size_t most_bytes) : buffer_(cobs_bytes(most_bytes)) {}

std::optional<std::span<const std::byte>> CobsDecoder::next() noexcept {
  while (!chunk_.empty()) {
    const auto zero = std::find(chunk_.begin(), chunk_.end(), std::byte{0});
    const auto before = static_cast<std::size_t>(zero - chunk_.begin());
    if (before > buffer_.size() - held_) {
      counters_.skipped_bytes += held_ + before;
      held_ = 0;
      overflowed_ = true;
    } else if (overflowed_) {
      counters_.skipped_bytes += before;
    } else if (before > 0) {
      std::memcpy(buffer_.data() + held_, chunk_.data(), before);
      held_ += before;
    }
    if (zero == chunk_.end()) {
      chunk_ = {};
      break;
    }
    chunk_ = chunk_.subspan(before + 1);
    const std::size_t length = held_;
    held_ = 0;
    if (overflowed_) {
      overflowed_ = false;
      ++counters_.too_long;
      continue;
    }
    if (length == 0) continue;  // zeros between frames
    const auto decoded = cobs_decode(std::span<const std::byte>(buffer_).first(length), buffer_);
    if (decoded) {
      ++counters_.frames;
      return std::span<const std::byte>(buffer_).first(*decoded);
    }
    ++counters_.broken;
    counters_.skipped_bytes += length;
  }
  return std::nullopt;
}

}  // namespace compueye::protocol
