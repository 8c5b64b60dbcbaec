#include "recon/core/bases/wavelet.hpp"

#include <cstring>

#include "recon/core/bases/strip.hpp"
#include "recon/core/parts/multiversion.hpp"

namespace compueye::recon::core {
namespace {

constexpr std::size_t longest_filter = 8;

/// Low-pass filters; the high-pass one is g[k] = (-1)^k h[length - 1 - k].
struct Filter {
  std::size_t length;
  double low[longest_filter];
};

constexpr Filter haar{2, {0.70710678118654752440, 0.70710678118654752440}};
constexpr Filter daubechies4{8,
                             {0.23037781330885523, 0.71484657055254153, 0.63088076792959036, -0.027983769416983849,
                              -0.18703481171888114, 0.030841381835986965, 0.032883011666982945, -0.010597401784997278}};

constexpr const Filter& filter_of(Wavelet kind) noexcept {
  return kind == Wavelet::haar ? haar : daubechies4;
}

/// One level down a strip of even length n: averages to the first half, details to the second.
template <class T>
COMPUEYE_INLINE void analyse_strip(const Filter& filter, std::size_t n, const T* __restrict strip, T* __restrict out) {
  const std::size_t half = n / 2;
  for (std::size_t k = 0; k < half; ++k) {
    T low[lanes] = {}, high[lanes] = {};
    for (std::size_t tap = 0; tap < filter.length; ++tap) {
      const T h = static_cast<T>(filter.low[tap]);
      const T mirrored = static_cast<T>(filter.low[filter.length - 1 - tap]);
      const T g = tap % 2 == 0 ? mirrored : -mirrored;
      const T* in = strip + ((2 * k + tap) % n) * lanes;
      for (std::size_t l = 0; l < lanes; ++l) {
        low[l] += h * in[l];
        high[l] += g * in[l];
      }
    }
    for (std::size_t l = 0; l < lanes; ++l) {
      out[k * lanes + l] = low[l];
      out[(half + k) * lanes + l] = high[l];
    }
  }
}

/// The transpose of analyse_strip().
template <class T>
COMPUEYE_INLINE void synthesise_strip(const Filter& filter, std::size_t n, const T* __restrict strip,
                                      T* __restrict out) {
  const std::size_t half = n / 2;
  for (std::size_t k = 0; k < n * lanes; ++k) out[k] = T(0);
  for (std::size_t k = 0; k < half; ++k) {
    const T *low = strip + k * lanes, *high = strip + (half + k) * lanes;
    for (std::size_t tap = 0; tap < filter.length; ++tap) {
      const T h = static_cast<T>(filter.low[tap]);
      const T mirrored = static_cast<T>(filter.low[filter.length - 1 - tap]);
      const T g = tap % 2 == 0 ? mirrored : -mirrored;
      T* to = out + ((2 * k + tap) % n) * lanes;
      for (std::size_t l = 0; l < lanes; ++l) to[l] += h * low[l] + g * high[l];
    }
  }
}

COMPUEYE_MULTIVERSION void analyse(const Filter& filter, std::size_t n, const float* strip, float* out) noexcept {
  analyse_strip(filter, n, strip, out);
}
COMPUEYE_MULTIVERSION void analyse(const Filter& filter, std::size_t n, const double* strip, double* out) noexcept {
  analyse_strip(filter, n, strip, out);
}
COMPUEYE_MULTIVERSION void synthesise(const Filter& filter, std::size_t n, const float* strip, float* out) noexcept {
  synthesise_strip(filter, n, strip, out);
}
COMPUEYE_MULTIVERSION void synthesise(const Filter& filter, std::size_t n, const double* strip, double* out) noexcept {
  synthesise_strip(filter, n, strip, out);
}

template <class T>
void forward_of(const WaveletShape& shape, const T* in, T* out, T* scratch) {
  const Filter& filter = filter_of(shape.kind);
  std::size_t rows = shape.rows, cols = shape.cols;
  if (in != out) std::memcpy(out, in, rows * cols * sizeof(T));
  for (int level = wavelet_levels(shape); level > 0; --level) {
    along_columns(rows, cols, shape.cols, out, out, scratch,
                  [&](T* strip, T* result, T*) { analyse(filter, rows, strip, result); });
    along_rows(rows, cols, shape.cols, out, out, scratch,
               [&](T* strip, T* result, T*) { analyse(filter, cols, strip, result); });
    rows /= 2;
    cols /= 2;
  }
}

template <class T>
void inverse_of(const WaveletShape& shape, const T* in, T* out, T* scratch) {
  const Filter& filter = filter_of(shape.kind);
  const int levels = wavelet_levels(shape);
  if (in != out) std::memcpy(out, in, shape.rows * shape.cols * sizeof(T));
  for (int level = levels; level > 0; --level) {
    const std::size_t rows = shape.rows >> (level - 1), cols = shape.cols >> (level - 1);
    along_rows(rows, cols, shape.cols, out, out, scratch,
               [&](T* strip, T* result, T*) { synthesise(filter, cols, strip, result); });
    along_columns(rows, cols, shape.cols, out, out, scratch,
                  [&](T* strip, T* result, T*) { synthesise(filter, rows, strip, result); });
  }
}

}  // namespace

int wavelet_levels(const WaveletShape& shape) noexcept {
  const std::size_t shortest = filter_of(shape.kind).length;
  std::size_t rows = shape.rows, cols = shape.cols;
  int levels = 0;
  while (rows % 2 == 0 && cols % 2 == 0 && rows >= shortest && cols >= shortest) {
    rows /= 2;
    cols /= 2;
    ++levels;
  }
  return levels;
}

void wavelet_forward(const WaveletShape& shape, const float* in, float* out, float* scratch) noexcept {
  forward_of(shape, in, out, scratch);
}
void wavelet_forward(const WaveletShape& shape, const double* in, double* out, double* scratch) noexcept {
  forward_of(shape, in, out, scratch);
}
void wavelet_inverse(const WaveletShape& shape, const float* in, float* out, float* scratch) noexcept {
  inverse_of(shape, in, out, scratch);
}
void wavelet_inverse(const WaveletShape& shape, const double* in, double* out, double* scratch) noexcept {
  inverse_of(shape, in, out, scratch);
}

}  // namespace compueye::recon::core
