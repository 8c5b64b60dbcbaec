#pragma once

#include <span>
#include <vector>

#include "recon/core/bases/basis.hpp"
#include "recon/core/parts/class_inverse.hpp"
#include "recon/problem/response.hpp"
#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// Whether a stored factor is what it is said to be: a checksum tells what the disk has done to it, not who made it.
/// Each is one product on a random vector, whose residual is a thousandth where rounding made it and a tenth where the
/// values are off by one; false from a twentieth on, and for a NaN.

/// (A K0^-1 A' + rho I) H v = v.
[[nodiscard]] bool inverts(const core::ClassInverse<float>& inverse, const Response& seeing,
                           const core::Metric<float>& metric, double rho);

/// A A' U s^-1 c = U c, U'U = I to four digits (frames diverge of less) s falls, and what follows the
/// modes bounds the rest of A A', class by class. `modes` as
/// leading_modes() packs them.
[[nodiscard]] bool are_modes(std::span<const float> modes, int rank, const Response& seeing,
                             const ParityClasses& classes);

}  // namespace compueye::recon
