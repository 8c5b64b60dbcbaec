#include "recon/core/operators/dense_runs.hpp"

#include "recon/core/operators/packed_rows.hpp"
#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

// Lanes in one vector: no more than the compiler can keep in registers for four rows at once. The 16 lanes of a sum are
// independent of each other, so this says nothing about bits.
#if defined(__x86_64__)
constexpr std::size_t width = 8;
#else
constexpr std::size_t width = 4;
#endif
constexpr std::size_t vectors = 16 / width;

template <class T>
using Vector = Wide<T, width>;

template <class T>
struct FullValues {
  static constexpr bool scaled = false;
  const T* at;
  explicit FullValues(const DenseRuns<T>& a) : at(a.values) {}
  void seek(std::size_t group) { at += 64 * group; }
  [[nodiscard]] COMPUEYE_INLINE FourRows<T, width> entries(std::size_t g, std::size_t h) const {
    const T* from = at + 64 * g + width * h;
    return {{load_wide<Vector<T>>(from), load_wide<Vector<T>>(from + 16), load_wide<Vector<T>>(from + 32),
             load_wide<Vector<T>>(from + 48)}};
  }
};

template <class T>
struct Bf16Values {
  static constexpr bool scaled = false;
  const std::uint32_t* at;
  explicit Bf16Values(const DenseRuns<T>& a) : at(a.words) {}
  void seek(std::size_t group) { at += 32 * group; }
  [[nodiscard]] COMPUEYE_INLINE FourRows<T, width> entries(std::size_t g, std::size_t h) const {
    const std::uint32_t* from = at + 32 * g + width * h;
    return bf16_rows<T, width>(from, from + 16);
  }
};

template <class T>
struct Int8Values {
  static constexpr bool scaled = true;
  const std::uint32_t* at;
  explicit Int8Values(const DenseRuns<T>& a) : at(a.words) {}
  void seek(std::size_t group) { at += 16 * group; }
  [[nodiscard]] COMPUEYE_INLINE FourRows<T, width> entries(std::size_t g, std::size_t h) const {
    return int8_rows<T, width>(at + 16 * g + width * h);
  }
};

template <class T>
COMPUEYE_INLINE T add_lanes(const Vector<T>* sums) {
  T sum[16];
  __builtin_memcpy(sum, sums, sizeof(sum));
  for (std::size_t half = 8; half > 0; half /= 2) {
    for (std::size_t l = 0; l < half; ++l) sum[l] += sum[l + half];
  }
  return sum[0];
}

template <class Values, class T>
COMPUEYE_INLINE void forward_blocks(const DenseRuns<T>& a, const T* x, T* y, std::size_t begin, std::size_t end) {
  Values values(a);
  values.seek(a.group[begin * a.bands]);
  for (std::size_t b = begin; b < end; ++b) {
    Vector<T> s0[vectors] = {}, s1[vectors] = {}, s2[vectors] = {}, s3[vectors] = {};
    for (std::size_t r = a.first[b * a.bands]; r < a.first[(b + 1) * a.bands]; ++r) {
      const T* pixels = x + a.start[r];
      const std::size_t groups = a.groups[r];
      for (std::size_t g = 0; g < groups; ++g) {
        for (std::size_t h = 0; h < vectors; ++h) {
          const auto v = load_wide<Vector<T>>(pixels + 16 * g + width * h);
          const FourRows<T, width> entry = values.entries(g, h);
          s0[h] += entry.of[0] * v;
          s1[h] += entry.of[1] * v;
          s2[h] += entry.of[2] * v;
          s3[h] += entry.of[3] * v;
        }
      }
      values.seek(groups);
    }
    const T sum[4] = {add_lanes<T>(s0), add_lanes<T>(s1), add_lanes<T>(s2), add_lanes<T>(s3)};
    for (std::size_t l = 0; l < 4; ++l) {
      if (a.row[4 * b + l] >= 0) y[a.row[4 * b + l]] = Values::scaled ? sum[l] * a.scale[4 * b + l] : sum[l];
    }
  }
}

template <class Values, class T>
COMPUEYE_INLINE void adjoint_runs(const DenseRuns<T>& a, Values values, std::size_t first, std::size_t last, const T* y,
                                  T* __restrict x) {
  for (std::size_t r = first; r < last; ++r) {
    T* pixels = x + a.start[r];
    const std::size_t groups = a.groups[r];
    for (std::size_t g = 0; g < groups; ++g) {
      for (std::size_t h = 0; h < vectors; ++h) {
        auto v = load_wide<Vector<T>>(pixels + 16 * g + width * h);
        const FourRows<T, width> entry = values.entries(g, h);
        v += entry.of[0] * y[0];
        v += entry.of[1] * y[1];
        v += entry.of[2] * y[2];
        v += entry.of[3] * y[3];
        __builtin_memcpy(pixels + 16 * g + width * h, &v, sizeof(v));
      }
    }
    values.seek(groups);
  }
}

template <class Values, class T>
COMPUEYE_INLINE void adjoint_bands(const DenseRuns<T>& a, const T* y, T* __restrict x, std::size_t begin,
                                   std::size_t end) {
  for (std::size_t b = 0; b < a.blocks; ++b) {
    T of_row[4];
    for (std::size_t l = 0; l < 4; ++l) {
      of_row[l] = a.row[4 * b + l] < 0 ? T(0) : y[a.row[4 * b + l]];
      if (Values::scaled) of_row[l] *= a.scale[4 * b + l];
    }
    Values values(a);
    values.seek(a.group[b * a.bands + begin]);
    adjoint_runs(a, values, a.first[b * a.bands + begin], a.first[b * a.bands + end], of_row, x);
  }
}

template <class T>
COMPUEYE_INLINE void forward_of(const DenseRuns<T>& a, const T* x, T* y, std::size_t begin, std::size_t end) {
  switch (a.stored) {
    case RunValues::full:
      return forward_blocks<FullValues<T>>(a, x, y, begin, end);
    case RunValues::bf16:
      return forward_blocks<Bf16Values<T>>(a, x, y, begin, end);
    case RunValues::int8:
      return forward_blocks<Int8Values<T>>(a, x, y, begin, end);
  }
}

template <class T>
COMPUEYE_INLINE void adjoint_of(const DenseRuns<T>& a, const T* y, T* x, std::size_t begin, std::size_t end) {
  switch (a.stored) {
    case RunValues::full:
      return adjoint_bands<FullValues<T>>(a, y, x, begin, end);
    case RunValues::bf16:
      return adjoint_bands<Bf16Values<T>>(a, y, x, begin, end);
    case RunValues::int8:
      return adjoint_bands<Int8Values<T>>(a, y, x, begin, end);
  }
}

COMPUEYE_MULTIVERSION void forward_part(const DenseRuns<float>& a, const float* x, float* y, std::size_t begin,
                                        std::size_t end) noexcept {
  forward_of(a, x, y, begin, end);
}
COMPUEYE_MULTIVERSION void forward_part(const DenseRuns<double>& a, const double* x, double* y, std::size_t begin,
                                        std::size_t end) noexcept {
  forward_of(a, x, y, begin, end);
}
COMPUEYE_MULTIVERSION void adjoint_part(const DenseRuns<float>& a, const float* y, float* x, std::size_t begin,
                                        std::size_t end) noexcept {
  adjoint_of(a, y, x, begin, end);
}
COMPUEYE_MULTIVERSION void adjoint_part(const DenseRuns<double>& a, const double* y, double* x, std::size_t begin,
                                        std::size_t end) noexcept {
  adjoint_of(a, y, x, begin, end);
}

template <class T>
void shared_forward(const DenseRuns<T>& a, const T* x, T* y, const Crew& crew) noexcept {
  const std::size_t groups = a.group[a.blocks * a.bands];
  crew.share(groups, flops(a), [&](std::size_t, std::size_t begin, std::size_t end) {
    forward_part(a, x, y, item_at(a.group, a.bands, a.blocks, begin), item_at(a.group, a.bands, a.blocks, end));
  });
}

template <class T>
void shared_adjoint(const DenseRuns<T>& a, const T* y, T* x, const Crew& crew) noexcept {
  crew.share(a.bands, flops(a),
             [&](std::size_t, std::size_t begin, std::size_t end) { adjoint_part(a, y, x, begin, end); });
}

template <class T>
std::size_t bytes_of(const DenseRuns<T>& a) {
  const std::size_t values = flops(a), runs = a.first[a.blocks * a.bands];
  const std::size_t scales = a.stored == RunValues::int8 ? 4 * a.blocks * sizeof(T) : 0;
  const std::size_t value_bytes = a.stored == RunValues::full ? sizeof(T) : a.stored == RunValues::bf16 ? 2 : 1;
  return values * value_bytes + runs * (sizeof(std::uint32_t) + sizeof(std::uint16_t)) +
         2 * (a.blocks * a.bands + 1) * sizeof(std::uint32_t) + 4 * a.blocks * sizeof(std::int32_t) + scales;
}

template <class T>
std::size_t flops_of(const DenseRuns<T>& a) {
  return 64 * std::size_t{a.group[a.blocks * a.bands]};
}

}  // namespace

std::size_t bytes(const DenseRuns<float>& a) noexcept {
  return bytes_of(a);
}
std::size_t bytes(const DenseRuns<double>& a) noexcept {
  return bytes_of(a);
}
std::size_t flops(const DenseRuns<float>& a) noexcept {
  return flops_of(a);
}
std::size_t flops(const DenseRuns<double>& a) noexcept {
  return flops_of(a);
}

void forward(const DenseRuns<float>& a, const float* x, float* y, const Crew& crew) noexcept {
  shared_forward(a, x, y, crew);
}
void forward(const DenseRuns<double>& a, const double* x, double* y, const Crew& crew) noexcept {
  shared_forward(a, x, y, crew);
}
void adjoint_accumulate(const DenseRuns<float>& a, const float* y, float* x, const Crew& crew) noexcept {
  shared_adjoint(a, y, x, crew);
}
void adjoint_accumulate(const DenseRuns<double>& a, const double* y, double* x, const Crew& crew) noexcept {
  shared_adjoint(a, y, x, crew);
}

}  // namespace compueye::recon::core
