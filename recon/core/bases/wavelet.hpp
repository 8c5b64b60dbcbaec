#pragma once

#include <cstddef>
#include <cstdint>

namespace compueye::recon::core {

enum class Wavelet : std::uint8_t { haar, db4 };

/// Orthonormal 2-D wavelet transforms of a rows x cols picture, periodic at its borders, in the nested layout of Mallat
/// (1989): after each level the averages fill the upper left quarter, which the next level takes apart.
///
/// haar: 2 taps. db4: 8 taps, four vanishing moments (Daubechies 1988, table 1, N = 4; "db4" in MATLAB and
/// PyWavelets). A level is taken while both sides are even and no shorter than the filter; 160 x 160 gives five levels
/// of haar and five of db4. A picture with an odd side has none, and its transform is the picture.
struct WaveletShape {
  Wavelet kind = Wavelet::haar;
  std::size_t rows = 0;
  std::size_t cols = 0;
};

[[nodiscard]] int wavelet_levels(const WaveletShape& shape) noexcept;

/// out = Psi in; in and out may be the same picture. `scratch` takes dct_scratch_size() elements, as every separable
/// transform does.
void wavelet_forward(const WaveletShape& shape, const float* in, float* out, float* scratch) noexcept;
void wavelet_forward(const WaveletShape& shape, const double* in, double* out, double* scratch) noexcept;

/// out = Psi' in, the inverse.
void wavelet_inverse(const WaveletShape& shape, const float* in, float* out, float* scratch) noexcept;
void wavelet_inverse(const WaveletShape& shape, const double* in, double* out, double* scratch) noexcept;

}  // namespace compueye::recon::core
