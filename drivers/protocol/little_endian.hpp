#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace compueye::protocol {

/// Numbers on the wire are little-endian and may lie at any address; these work on every host. The caller has checked
/// that sizeof(T) bytes are there.
template <std::unsigned_integral T>
[[nodiscard]] constexpr T swapped_bytes(T value) noexcept {
  T swapped = 0;
  for (std::size_t k = 0; k < sizeof(T); ++k) {
    swapped = static_cast<T>(swapped | static_cast<T>((value >> (8U * k)) & 0xFFU) << (8U * (sizeof(T) - 1 - k)));
  }
  return swapped;
}

template <std::integral T>
[[nodiscard]] inline T load_little(const std::byte* at) noexcept {
  std::make_unsigned_t<T> value;
  std::memcpy(&value, at, sizeof value);
  if constexpr (std::endian::native == std::endian::big) value = swapped_bytes(value);
  return static_cast<T>(value);
}

template <std::integral T>
inline void store_little(std::byte* at, T number) noexcept {
  auto value = static_cast<std::make_unsigned_t<T>>(number);
  if constexpr (std::endian::native == std::endian::big) value = swapped_bytes(value);
  std::memcpy(at, &value, sizeof value);
}

}  // namespace compueye::protocol
