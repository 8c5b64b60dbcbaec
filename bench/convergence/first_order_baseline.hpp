#pragma once

#include <string>
#include <vector>

#include "bench/eyes.hpp"
#include "hal/result.hpp"

namespace compueye::bench {

/// A solver that needs nothing but products with A, on Eigen's sparse matrix.
struct Contestant {
  std::string name;
  int iterations = 0;     ///< until the mean NMSE of eight scenes is that of pdhg; 0: not within `most`
  int most = 0;           ///< how many were tried
  double best = 0.0;      ///< lowest mean NMSE of any iteration looked at
  double plain_ms = 0.0;  ///< Eigen's products with A and A' alone, with our flags, for `iterations` or `most`
  double fast_ms = 0.0;   ///< the same with -O3 -ffast-math -march=native
};

/// What the same picture costs without a factor: line art on the 80x80 eye, lambda by rule.
struct FirstOrderBaseline {
  std::string noise;
  int ours = 0;  ///< iterations of pdhg in the DCT with x >= 0, which stay within 5 % of converged
  double ours_ms = 0.0;
  double nmse = 0.0;  ///< mean, what the contestants have to reach
  std::vector<Contestant> contestants;
};

/// FISTA in the DCT, which takes no constraint, with pictures cut to x >= 0 afterwards; FISTA in pixels with x >= 0;
/// and the paper's ADM as published, in the DCT, cut likewise. At 30 dB and at the paper's noise.
[[nodiscard]] hal::Result<std::vector<FirstOrderBaseline>> measure_first_order_baselines(const Eye& eye);

}  // namespace compueye::bench
