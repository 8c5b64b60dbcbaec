#pragma once

namespace compueye::recon {

/// The share, 0 .. 1 and never all, that work expected to take `expected` seconds has likely done after `elapsed`; 0
/// where nothing is expected.
[[nodiscard]] constexpr double likely_share(double elapsed, double expected) noexcept {
  constexpr double nearly = 0.9;
  if (!(expected > 0.0)) return 0.0;
  const double share = elapsed / expected;
  return share < nearly ? share : 1.0 - (1.0 - nearly) * nearly / share;
}

}  // namespace compueye::recon
