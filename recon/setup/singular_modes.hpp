#pragma once

#include <vector>

#include "recon/setup/factor.hpp"

namespace compueye::recon {

/// Leading singular pairs of a response, largest first.
struct ModeTable {
  int order = 0;               ///< number of seeing rows
  std::vector<double> values;  ///< singular values, as many as the rank
  std::vector<double> left;    ///< order x rank, row-major: left singular vectors as columns
};

/// The singular pairs of A that stand above rounding (s > 1e-6 s_max), in double, from the eigenvectors of A A' in each
/// parity class, or of a tall A from those of its triangle; at most `rank` of them (0: all), and only those with s^2 >=
/// `least_square`. `seeing` has no blind rows. Cubic in the shorter side: a quarter of a minute for 4,564 rows that are
/// mirror symmetric, many minutes for as many that are not. Errors: interrupted; out_of_range when fewer than `rank`
/// pairs stand above rounding, or none reaches least_square.
[[nodiscard]] hal::Result<ModeTable> singular_modes(const Response& seeing, int rank, double least_square,
                                                    const Progress& progress);

}  // namespace compueye::recon
