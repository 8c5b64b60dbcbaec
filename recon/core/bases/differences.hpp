#pragma once

#include <cstddef>

#include "recon/core/parts/crew.hpp"

namespace compueye::recon::core {

/// Forward differences D of a rows x cols picture, whose l1 norm is the anisotropic total variation (Rudin, Osher &
/// Fatemi 1992 in its l1 form): 2 N numbers, workers sharing rows; first all steps to the right, then all steps down;
/// steps across the border are zero. D'D is diagonal in the 2-D DCT, with eigenvalue (2 - 2 cos(pi i/rows)) + (2 - 2
/// cos(pi k/cols)).
void differences(const float* x, std::size_t rows, std::size_t cols, float* d, const Crew& crew = {}) noexcept;
void differences(const double* x, std::size_t rows, std::size_t cols, double* d, const Crew& crew = {}) noexcept;

/// x = D' d
void differences_adjoint(const float* d, std::size_t rows, std::size_t cols, float* x, const Crew& crew = {}) noexcept;
void differences_adjoint(const double* d, std::size_t rows, std::size_t cols, double* x,
                         const Crew& crew = {}) noexcept;

}  // namespace compueye::recon::core
