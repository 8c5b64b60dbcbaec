#pragma once

#include "bench/eyes.hpp"
#include "hal/result.hpp"

namespace compueye::bench {

/// What the same picture costs by FISTA on Eigen's sparse matrix: DCT without a constraint, which is all that FISTA
/// takes, at 30 dB on the 80x80 eye, until the mean NMSE of eight scenes is that of pdhg at its 5 %.
struct FistaBaseline {
  int ours = 0;  ///< iterations of pdhg on the same problem
  double ours_ms = 0.0;
  double nmse = 0.0;   ///< mean, that both reach
  int iterations = 0;  ///< of FISTA; 0: not within `most`
  int most = 0;
  double plain_ms = 0.0;  ///< Eigen's A and A' alone, with our flags; FISTA's DCT and threshold are not counted
  double fast_ms = 0.0;   ///< the same with -O3 -ffast-math -march=native
};

[[nodiscard]] hal::Result<FistaBaseline> measure_fista_baseline(const Eye& eye);

}  // namespace compueye::bench
