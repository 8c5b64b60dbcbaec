#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace compueye::protocol {

/// Consistent Overhead Byte Stuffing: makes any bytes free of 0, so that a 0 can end them on a UART. Source: Cheshire
/// and Baker, IEEE/ACM Transactions on Networking 7(2), 1999.

/// The longest encoding of `bytes` bytes, without the 0 that ends it.
[[nodiscard]] constexpr std::size_t cobs_bytes(std::size_t bytes) noexcept {
  return bytes + bytes / 254 + 1;
}

/// Encodes without the ending 0. Returns the length; 0 when `into` is shorter than cobs_bytes(data.size()).
std::size_t cobs_encode(std::span<const std::byte> data, std::span<std::byte> into) noexcept;

/// Decodes what stood between two zeros. Returns the length, nothing when the encoding is broken (a 0 inside, a block
/// that runs over the end, empty) or `into` too small. `into` may begin where `encoded` does.
[[nodiscard]] std::optional<std::size_t> cobs_decode(std::span<const std::byte> encoded,
                                                     std::span<std::byte> into) noexcept;

struct CobsCounters {
  std::uint64_t frames = 0;         ///< decoded
  std::uint64_t broken = 0;         ///< encodings that could not be
  std::uint64_t too_long = 0;       ///< longer than the longest frame
  std::uint64_t skipped_bytes = 0;  ///< of both
};

/// Cuts a byte stream at its zeros and decodes what lies between. Memory is made at set-up.
///
///   decoder.feed(chunk);
///   while (const auto frame = decoder.next()) ...
class CobsDecoder {
 public:
  /// `most_bytes`: of a decoded frame.
  explicit CobsDecoder(std::size_t most_bytes);
  /// `chunk` must live until next() has returned nothing.
  void feed(std::span<const std::byte> chunk) noexcept { chunk_ = chunk; }
  /// The next frame, valid until the next call; nothing: feed more.
  [[nodiscard]] std::optional<std::span<const std::byte>> next() noexcept;
  [[nodiscard]] const CobsCounters& counters() const noexcept { return counters_; }

 private:
  std::vector<std::byte> buffer_;
  std::size_t held_ = 0;
  bool overflowed_ = false;
  std::span<const std::byte> chunk_;
  CobsCounters counters_;
};

}  // namespace compueye::protocol
