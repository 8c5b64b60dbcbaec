#pragma once

#include <cstddef>

namespace compueye::recon::core {

/// Forward differences D of a rows x cols picture, whose l1 norm is the anisotropic total variation (Rudin, Osher &
/// Fatemi 1992 in its l1 form): 2 N numbers, first all steps to the right, then all steps down; steps across the
/// border are zero. D'D is diagonal in the 2-D DCT, with eigenvalue (2 - 2 cos(pi i/rows)) + (2 - 2 cos(pi k/cols)).
void differences(const float* x, std::size_t rows, std::size_t cols, float* d) noexcept;
void differences(const double* x, std::size_t rows, std::size_t cols, double* d) noexcept;

/// x = D' d
void differences_adjoint(const float* d, std::size_t rows, std::size_t cols, float* x) noexcept;
void differences_adjoint(const double* d, std::size_t rows, std::size_t cols, double* x) noexcept;

}  // namespace compueye::recon::core
