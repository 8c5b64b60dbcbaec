#pragma once

#include <cstddef>

#include "recon/core/parts/multiversion.hpp"
#include "recon/core/parts/thin_step.hpp"

namespace compueye::recon::core {

// The parts of a thin step number by number, in the order and so with the bits of core/thin_step.cpp's vectors: for a
// Cortex-M, where g++ 12 gives vectors of 64 bytes kilobytes of stack, whose alignment it assumes and does not get.

template <class T>
COMPUEYE_STAGE void turn_picture(T* v, std::size_t cols) {
  for (std::size_t k = 0; k < cols; k += 4) {
    const T a = v[k] + v[k + 1], b = v[k] - v[k + 1], c = v[k + 2] + v[k + 3], d = v[k + 2] - v[k + 3];
    v[k] = T(0.5) * (a + c);
    v[k + 1] = T(0.5) * (b + d);
    v[k + 2] = T(0.5) * (a - c);
    v[k + 3] = T(0.5) * (b - d);
  }
}

template <class T, std::size_t lanes>
COMPUEYE_STAGE void subtract_forward(const ThinStep<T>& step, const T* gains, const T* samples, const T* v,
                                     T* residual) {
  for (std::size_t i = 0; i < step.rows; ++i) {
    const T* row = step.turned + i * step.cols;
    T sum[16] = {};
    for (std::size_t k = 0; k < step.cols; k += 16) {
      for (std::size_t l = 0; l < 16; ++l) sum[l] += row[k + l] * v[k + l];
    }
    for (std::size_t half = 8; half >= lanes; half /= 2) {
      for (std::size_t l = 0; l < half; ++l) sum[l] += sum[l + half];
    }
    for (std::size_t l = 0; l < 16; ++l)
      residual[16 * i + l] = gains[i * lanes + l % lanes] * (samples[16 * i + l] - sum[l % lanes]);
  }
}

template <class T>
COMPUEYE_STAGE void add_adjoint(const ThinStep<T>& step, const T* residual, T* v) {
  for (std::size_t first = 0; first < step.cols; first += 16) {
    T sum[16];
    for (std::size_t l = 0; l < 16; ++l) sum[l] = v[first + l];
    for (std::size_t i = 0; i < step.rows; ++i) {
      const T *row = step.turned + i * step.cols + first, *scale = residual + 16 * i;
      for (std::size_t l = 0; l < 16; ++l) sum[l] += row[l] * scale[l];
    }
    for (std::size_t l = 0; l < 16; ++l) v[first + l] = sum[l];
  }
}

}  // namespace compueye::recon::core
