#pragma once

#include <vector>

namespace compueye::recon {

/// Values of a core::DctTable for `length` >= 1, made in double and rounded once.
template <class T>
[[nodiscard]] std::vector<T> make_dct_table(int length);

/// A length x length table of core::Fourier2d, length >= 1, made in double and rounded once.
template <class T>
[[nodiscard]] std::vector<T> make_fourier_table(int length);

/// Eigenvalues of D'D + I for forward differences D on an image_rows x image_cols picture, one a 2-D DCT coefficient in
/// row-major order: 1 + (2 - 2 cos(pi i/rows)) + (2 - 2 cos(pi k/cols)) (Strang 1999, "The discrete cosine transform").
[[nodiscard]] std::vector<double> smoothing_eigenvalues(int image_rows, int image_cols);

}  // namespace compueye::recon
