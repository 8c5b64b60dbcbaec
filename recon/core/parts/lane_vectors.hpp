#pragma once

#include <cstddef>

#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {

// Four or eight numbers that are added and multiplied lane by lane: the compiler's own vectors, or plain numbers where
// the processor has no vectors, for which g++ would keep them on the stack.
#if defined(COMPUEYE_PLAIN_LANES)
template <class T, std::size_t lane_count>
struct Lanes {
  T lane[lane_count];

  [[nodiscard]] COMPUEYE_INLINE T operator[](std::size_t l) const { return lane[l]; }
  [[nodiscard]] COMPUEYE_INLINE T& operator[](std::size_t l) { return lane[l]; }
  COMPUEYE_INLINE Lanes& operator+=(const Lanes& other) {
    for (std::size_t l = 0; l < lane_count; ++l) lane[l] += other.lane[l];
    return *this;
  }
  [[nodiscard]] friend COMPUEYE_INLINE Lanes operator+(Lanes left, const Lanes& right) { return left += right; }
  [[nodiscard]] friend COMPUEYE_INLINE Lanes operator*(T scale, Lanes v) {
    for (std::size_t l = 0; l < lane_count; ++l) v.lane[l] = scale * v.lane[l];
    return v;
  }
};
template <class T>
using Four = Lanes<T, 4>;

/// Lane l of the result is lane l ^ flip of v, in every four lanes.
template <std::size_t flip, class T, std::size_t lane_count>
COMPUEYE_INLINE Lanes<T, lane_count> flipped(const Lanes<T, lane_count>& v) {
  Lanes<T, lane_count> out;
  for (std::size_t l = 0; l < lane_count; ++l) out[l] = v[l ^ flip];
  return out;
}

template <class T>
COMPUEYE_INLINE Four<T> reversed(const Four<T>& v) {
  return {{v[3], v[2], v[1], v[0]}};
}

template <class T>
COMPUEYE_INLINE void transpose(Four<T> (&v)[4]) {
  const Four<T> a = v[0], b = v[1], c = v[2], d = v[3];
  v[0] = {{a[0], b[0], c[0], d[0]}};
  v[1] = {{a[1], b[1], c[1], d[1]}};
  v[2] = {{a[2], b[2], c[2], d[2]}};
  v[3] = {{a[3], b[3], c[3], d[3]}};
}
#else
template <class T, std::size_t lane_count>
struct LaneVector;
template <>
struct LaneVector<float, 4> {
  using type = float __attribute__((vector_size(16)));
};
template <>
struct LaneVector<double, 4> {
  using type = double __attribute__((vector_size(32)));
};
template <>
struct LaneVector<float, 8> {
  using type = float __attribute__((vector_size(32)));
};
template <>
struct LaneVector<double, 8> {
  using type = double __attribute__((vector_size(64)));
};
template <class T, std::size_t lane_count>
using Lanes = typename LaneVector<T, lane_count>::type;
template <class T>
using Four = Lanes<T, 4>;

/// Lane l of the result is lane l ^ flip of v, in every four lanes.
template <std::size_t flip, class T>
COMPUEYE_INLINE void flip_four(T* v) {
  if constexpr (flip == 0) return;
  Four<T> four;
  __builtin_memcpy(&four, v, sizeof(four));
  if constexpr (flip == 1) four = __builtin_shufflevector(four, four, 1, 0, 3, 2);
  if constexpr (flip == 2) four = __builtin_shufflevector(four, four, 2, 3, 0, 1);
  if constexpr (flip == 3) four = __builtin_shufflevector(four, four, 3, 2, 1, 0);
  __builtin_memcpy(v, &four, sizeof(four));
}

template <std::size_t flip, class T, std::size_t lane_count>
COMPUEYE_INLINE Lanes<T, lane_count> flipped(Lanes<T, lane_count> v) {
  T numbers[lane_count];
  __builtin_memcpy(numbers, &v, sizeof(v));
  for (std::size_t l = 0; l < lane_count; l += 4) flip_four<flip>(numbers + l);
  __builtin_memcpy(&v, numbers, sizeof(v));
  return v;
}

template <class T>
COMPUEYE_INLINE Four<T> reversed(Four<T> v) {
  return __builtin_shufflevector(v, v, 3, 2, 1, 0);
}

template <class T>
COMPUEYE_INLINE void transpose(Four<T> (&v)[4]) {
  const Four<T> a = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5),
                b = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5);
  const Four<T> c = __builtin_shufflevector(v[0], v[1], 2, 6, 3, 7),
                d = __builtin_shufflevector(v[2], v[3], 2, 6, 3, 7);
  v[0] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
  v[1] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
  v[2] = __builtin_shufflevector(c, d, 0, 1, 4, 5);
  v[3] = __builtin_shufflevector(c, d, 2, 3, 6, 7);
}
#endif

template <class T>
COMPUEYE_INLINE Four<T> load_four(const T* from) {
  Four<T> v;
  __builtin_memcpy(&v, from, sizeof(v));
  return v;
}

template <class T>
COMPUEYE_INLINE void store_four(const Four<T>& v, T* to) {
  __builtin_memcpy(to, &v, sizeof(v));
}

}  // namespace compueye::recon::core
