#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace compueye::fuzz {

/// Takes a fuzzer's bytes apart from the front. Behind the end there are zeros.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(std::as_bytes(std::span(data, size))) {}

  [[nodiscard]] std::uint8_t byte() {
    return rest_.empty() ? std::uint8_t{0} : std::to_integer<std::uint8_t>(take(1)[0]);
  }
  [[nodiscard]] std::uint16_t word() {
    const unsigned low = byte();
    return static_cast<std::uint16_t>(low | static_cast<unsigned>(byte()) << 8U);
  }
  /// At most `count` bytes.
  [[nodiscard]] std::span<const std::byte> take(std::size_t count) {
    const auto taken = rest_.first(std::min(count, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  [[nodiscard]] bool empty() const { return rest_.empty(); }
  [[nodiscard]] std::size_t size() const { return rest_.size(); }

 private:
  std::span<const std::byte> rest_;
};

}  // namespace compueye::fuzz
