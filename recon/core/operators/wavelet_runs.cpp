#include "recon/core/operators/wavelet_runs.hpp"

#include "recon/core/operators/packed_rows.hpp"
#include "recon/core/parts/lane_vectors.hpp"
#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/vector_sums.hpp"

namespace compueye::recon::core {
namespace {

constexpr std::size_t tile = WaveletPicture::tile;
static_assert(tile == lanes);

struct Bf16Tiles {
  static constexpr std::size_t words_a_tile = WaveletRuns<float>::average_words;
  template <class T, std::size_t width>
  static COMPUEYE_INLINE FourRows<T, width> rows(const std::uint32_t* words, std::size_t k) {
    return bf16_rows<T, width>(words + k, words + 16 + k);
  }
};

struct Int8Tiles {
  static constexpr std::size_t words_a_tile = WaveletRuns<float>::detail_words;
  template <class T, std::size_t width>
  static COMPUEYE_INLINE FourRows<T, width> rows(const std::uint32_t* words, std::size_t k) {
    return int8_rows<T, width>(words + k);
  }
};

/// 16 lanes of each of four rows.
template <class T, std::size_t width>
struct Sums {
  static constexpr std::size_t vectors = lanes / width;
  Wide<T, width> of[4][vectors] = {};
};

template <class Stored, std::size_t width, class T>
COMPUEYE_INLINE Sums<T, width> sums_of(const typename WaveletRuns<T>::Tiles& tiles, std::size_t begin, std::size_t end,
                                       const T* coefficients) {
  using V = Wide<T, width>;
  constexpr std::size_t vectors = Sums<T, width>::vectors;
  V s0[vectors] = {}, s1[vectors] = {}, s2[vectors] = {}, s3[vectors] = {};
  const std::uint32_t* words = tiles.words + Stored::words_a_tile * begin;
  for (std::size_t t = begin; t < end; ++t, words += Stored::words_a_tile) {
    const T* at = coefficients + tile * tiles.place[t];
    for (std::size_t h = 0; h < vectors; ++h) {
      const auto v = load_wide<V>(at + h * width);
      const FourRows<T, width> entry = Stored::template rows<T, width>(words, h * width);
      s0[h] += entry.of[0] * v;
      s1[h] += entry.of[1] * v;
      s2[h] += entry.of[2] * v;
      s3[h] += entry.of[3] * v;
    }
  }
  Sums<T, width> sums;
  for (std::size_t h = 0; h < vectors; ++h) {
    sums.of[0][h] = s0[h];
    sums.of[1][h] = s1[h];
    sums.of[2][h] = s2[h];
    sums.of[3][h] = s3[h];
  }
  return sums;
}

/// The sums over the lanes of four rows: lanes 8 apart are added, then those 4, 2 and 1 apart.
template <class T, std::size_t width>
COMPUEYE_INLINE void add_lanes(const Sums<T, width>& sums, T* four) {
  Four<T> quarter[4];
  for (std::size_t l = 0; l < 4; ++l) {
    T lane[lanes];
    __builtin_memcpy(lane, sums.of[l], sizeof(lane));
    quarter[l] = (load_four(lane) + load_four(lane + 8)) + (load_four(lane + 4) + load_four(lane + 12));
  }
  transpose<T>(quarter);
  store_four<T>((quarter[0] + quarter[2]) + (quarter[1] + quarter[3]), four);
}

template <std::size_t width, class T>
COMPUEYE_INLINE void forward_blocks(const WaveletRuns<T>& a, const T* coefficients, T* y, std::size_t begin,
                                    std::size_t end) {
  for (std::size_t b = begin; b < end; ++b) {
    const std::size_t from = b * a.bands, to = from + a.bands;
    auto sums = sums_of<Bf16Tiles, width, T>(a.averages, a.averages.first[from], a.averages.first[to], coefficients);
    const auto details =
        sums_of<Int8Tiles, width, T>(a.details, a.details.first[from], a.details.first[to], coefficients);
    for (std::size_t l = 0; l < 4; ++l) {
      for (std::size_t h = 0; h < lanes / width; ++h) sums.of[l][h] += a.scale[4 * b + l] * details.of[l][h];
    }
    T four[4];
    add_lanes<T, width>(sums, four);
    for (std::size_t l = 0; l < 4; ++l) {
      if (a.row[4 * b + l] >= 0) y[a.row[4 * b + l]] = four[l];
    }
  }
}

template <class Stored, std::size_t width, class T>
COMPUEYE_INLINE void spread(const typename WaveletRuns<T>::Tiles& tiles, std::size_t begin, std::size_t end,
                            const T* of_row, T* __restrict coefficients) {
  using V = Wide<T, width>;
  const T y0 = of_row[0], y1 = of_row[1], y2 = of_row[2], y3 = of_row[3];
  const std::uint32_t* words = tiles.words + Stored::words_a_tile * begin;
  for (std::size_t t = begin; t < end; ++t, words += Stored::words_a_tile) {
    T* at = coefficients + tile * tiles.place[t];
    for (std::size_t k = 0; k < tile; k += width) {
      auto v = load_wide<V>(at + k);
      const FourRows<T, width> entry = Stored::template rows<T, width>(words, k);
      v += entry.of[0] * y0;
      v += entry.of[1] * y1;
      v += entry.of[2] * y2;
      v += entry.of[3] * y3;
      __builtin_memcpy(at + k, &v, sizeof(v));
    }
  }
}

template <std::size_t width, class T>
COMPUEYE_INLINE void adjoint_bands(const WaveletRuns<T>& a, const T* y, T* __restrict coefficients, std::size_t begin,
                                   std::size_t end) {
  for (std::size_t k = tile * a.band[begin]; k < tile * a.band[end]; ++k) coefficients[k] = T(0);
  for (std::size_t b = 0; b < a.blocks; ++b) {
    T plain[4], scaled[4];
    for (std::size_t l = 0; l < 4; ++l) {
      plain[l] = a.row[4 * b + l] < 0 ? T(0) : y[a.row[4 * b + l]];
      scaled[l] = plain[l] * a.scale[4 * b + l];
    }
    const std::size_t from = b * a.bands + begin, to = b * a.bands + end;
    spread<Bf16Tiles, width, T>(a.averages, a.averages.first[from], a.averages.first[to], plain, coefficients);
    spread<Int8Tiles, width, T>(a.details, a.details.first[from], a.details.first[to], scaled, coefficients);
  }
}

enum class Step { forward, adjoint };

template <std::size_t width, class T>
COMPUEYE_INLINE void step_of(Step step, const WaveletRuns<T>& a, const T* in, T* out, std::size_t begin,
                             std::size_t end) {
  if (step == Step::forward) return forward_blocks<width>(a, in, out, begin, end);
  return adjoint_bands<width>(a, in, out, begin, end);
}

// As many lanes in a vector as registers hold for four rows at once. The 16 lanes of a sum are independent of each
// other, so this says nothing about bits.
#if defined(__x86_64__)
constexpr std::size_t usual_width = 8;
#else
constexpr std::size_t usual_width = 4;
#endif

COMPUEYE_MULTIVERSION void do_usual_step(Step step, const WaveletRuns<float>& a, const float* in, float* out,
                                         std::size_t begin, std::size_t end) noexcept {
  step_of<usual_width>(step, a, in, out, begin, end);
}

#if defined(COMPUEYE_WIDEST)
COMPUEYE_WIDEST void do_wide_step(Step step, const WaveletRuns<float>& a, const float* in, float* out,
                                  std::size_t begin, std::size_t end) noexcept {
  step_of<16>(step, a, in, out, begin, end);
}
#endif

void do_step(Step step, const WaveletRuns<float>& a, const float* in, float* out, std::size_t begin,
             std::size_t end) noexcept {
#if defined(COMPUEYE_WIDEST)
  if (has_widest_vectors()) return do_wide_step(step, a, in, out, begin, end);
#endif
  do_usual_step(step, a, in, out, begin, end);
}
COMPUEYE_MULTIVERSION void do_step(Step step, const WaveletRuns<double>& a, const double* in, double* out,
                                   std::size_t begin, std::size_t end) noexcept {
  step_of<4>(step, a, in, out, begin, end);
}

template <class T>
std::size_t tiles_of(const typename WaveletRuns<T>::Tiles& tiles, const WaveletRuns<T>& a) noexcept {
  return tiles.first[a.blocks * a.bands];
}

template <class T>
std::size_t products_of(const WaveletRuns<T>& a) noexcept {
  return 4 * tile * (tiles_of(a.averages, a) + tiles_of(a.details, a));
}

/// The scratch behind coefficients and a picture.
template <class T>
T* behind_picture(const WaveletRuns<T>& a, T* picture) noexcept {
  return picture + (a.picture.rows * a.picture.cols + lanes - 1) / lanes * lanes;
}

template <class T>
void forward_of(const WaveletRuns<T>& a, const T* x, T* y, T* scratch, const Crew& crew) noexcept {
  T* const picture = scratch + a.picture.coefficients();
  wavelet_measure(a.picture, x, scratch, behind_picture(a, picture), crew);
  crew.share(tiles_of(a.details, a), products_of(a), [&](std::size_t, std::size_t begin, std::size_t end) {
    do_step(Step::forward, a, scratch, y, item_at(a.details.first, a.bands, a.blocks, begin),
            item_at(a.details.first, a.bands, a.blocks, end));
  });
}

template <class T>
void adjoint_of(const WaveletRuns<T>& a, const T* y, T* x, T* scratch, const Crew& crew) noexcept {
  T* const picture = scratch + a.picture.coefficients();
  crew.share(a.bands, products_of(a), [&](std::size_t, std::size_t begin, std::size_t end) {
    do_step(Step::adjoint, a, y, scratch, begin, end);
  });
  wavelet_synthesise(a.picture, scratch, picture, behind_picture(a, picture), crew);
  accumulate(picture, T(1), x, a.picture.rows * a.picture.cols);
}

template <class T>
std::size_t bytes_of(const WaveletRuns<T>& a) noexcept {
  const std::size_t averages = tiles_of(a.averages, a), details = tiles_of(a.details, a);
  return 4 * (Bf16Tiles::words_a_tile * averages + Int8Tiles::words_a_tile * details) +
         sizeof(std::uint16_t) * (averages + details) +
         sizeof(std::uint32_t) * (2 * (a.blocks * a.bands + 1) + a.bands + 1) +
         4 * a.blocks * (sizeof(T) + sizeof(std::int32_t));
}

/// Each of four steps lifts every second element by two additions and a product, and there is a scale, down and across.
template <class T>
std::size_t flops_of(const WaveletRuns<T>& a) noexcept {
  const std::size_t lifted = a.picture.rows * a.picture.cols + a.picture.rows_at(1) * a.picture.cols_at(1);
  return products_of(a) + 2 * (4 + 1) * lifted;
}

}  // namespace

std::size_t bytes(const WaveletRuns<float>& a) noexcept {
  return bytes_of(a);
}
std::size_t bytes(const WaveletRuns<double>& a) noexcept {
  return bytes_of(a);
}
std::size_t flops(const WaveletRuns<float>& a) noexcept {
  return flops_of(a);
}
std::size_t flops(const WaveletRuns<double>& a) noexcept {
  return flops_of(a);
}

void forward(const WaveletRuns<float>& a, const float* x, float* y, float* scratch, const Crew& crew) noexcept {
  forward_of(a, x, y, scratch, crew);
}
void forward(const WaveletRuns<double>& a, const double* x, double* y, double* scratch, const Crew& crew) noexcept {
  forward_of(a, x, y, scratch, crew);
}
void adjoint_accumulate(const WaveletRuns<float>& a, const float* y, float* x, float* scratch,
                        const Crew& crew) noexcept {
  adjoint_of(a, y, x, scratch, crew);
}
void adjoint_accumulate(const WaveletRuns<double>& a, const double* y, double* x, double* scratch,
                        const Crew& crew) noexcept {
  adjoint_of(a, y, x, scratch, crew);
}

}  // namespace compueye::recon::core
