#pragma once

#include <cstddef>
#include <vector>

#include "hal/result.hpp"
#include "recon/setup/factor.hpp"
#include "recon/setup/mirror_symmetry.hpp"

namespace compueye::recon {

/// Those of the rows, by which modes are stored: a tall response has one, for its modes come from its pixels.
[[nodiscard]] ParityClasses mode_classes(const Response& seeing);

/// How many modes a class of `order` rows has in its table, of `rank` in all: as many in each class, all where that is
/// most of them.
[[nodiscard]] std::size_t modes_of_class(const ParityClasses& classes, std::size_t parity_class, int rank) noexcept;

/// Values that the modes of all classes take.
[[nodiscard]] std::size_t modes_size(const ParityClasses& classes, int rank) noexcept;

/// Leading eigenvectors of A A' by mode_classes(), made in double, kept in float32. One class after the other:
/// modes_of_class() eigenvalues, largest first; the next eigenvalue, which bounds all that are left out (0: none is);
/// then the vectors, row-major, a row of A (or an orbit of rows) each. `seeing` has no blind rows; rank >= 1.
/// A vector whose singular value is below 1e-6 of the largest is all nought, and left out with the rest. Seconds for
/// 4,564 rows that are mirror symmetric. Errors: interrupted; unsupported: the eigenvalues do not settle.
[[nodiscard]] hal::Result<std::vector<float>> leading_modes(const Response& seeing, int rank, const Progress& progress);

}  // namespace compueye::recon
