#pragma once

#include <cstddef>
#include <cstdint>

#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {

// Entries of four rows of A that are stored side by side in 32-bit words, at as many neighbouring pixels as a vector
// has lanes.

template <class T, std::size_t width>
struct WideVector {
  using type __attribute__((vector_size(sizeof(T) * width))) = T;
};
template <class T, std::size_t width>
using Wide = typename WideVector<T, width>::type;

template <class V, class T>
COMPUEYE_INLINE V load_wide(const T* from) {
  V v;
  __builtin_memcpy(&v, from, sizeof(V));
  return v;
}

template <class T, std::size_t width>
struct FourRows {
  Wide<T, width> of[4];
};

/// Each word the upper halves of two floats, the first row's lower; rows 0 and 1 at `from`, 2 and 3 at `next`.
template <class T, std::size_t width>
COMPUEYE_INLINE FourRows<T, width> bf16_rows(const std::uint32_t* from, const std::uint32_t* next) {
  using Words = Wide<std::int32_t, width>;
  using Floats = Wide<float, width>;
  constexpr auto upper = static_cast<std::int32_t>(0xFFFF0000U);
  const auto widened = [](Words bits) __attribute__((always_inline)) {
    return __builtin_convertvector(reinterpret_cast<Floats>(bits), Wide<T, width>);
  };
  const auto first = load_wide<Words>(from), second = load_wide<Words>(next);
  return {{widened(first << 16), widened(first & upper), widened(second << 16), widened(second & upper)}};
}

/// Each word four whole numbers -128 .. 127, row 0 in its lowest byte.
template <class T, std::size_t width>
COMPUEYE_INLINE FourRows<T, width> int8_rows(const std::uint32_t* from) {
  using V = Wide<T, width>;
  const auto four = load_wide<Wide<std::int32_t, width>>(from);
  return {{__builtin_convertvector((four << 24) >> 24, V), __builtin_convertvector((four << 16) >> 24, V),
           __builtin_convertvector((four << 8) >> 24, V), __builtin_convertvector(four >> 24, V)}};
}

}  // namespace compueye::recon::core
