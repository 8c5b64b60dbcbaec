#pragma once

#include <vector>

namespace compueye::recon {

/// A length x length table of core::Fourier2d, length >= 1, made in double and rounded once.
template <class T>
[[nodiscard]] std::vector<T> make_fourier_table(int length);

}  // namespace compueye::recon
