#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "bench/eyes.hpp"
#include "hal/result.hpp"
#include "recon/reconstructor.hpp"

namespace compueye::golden {

/// A frame that every processor must solve to the same bits, and whose instructions are counted. A new line in
/// cases.cpp and one in CMakeLists.txt are all that another takes.
struct Case {
  std::string_view name;
  bench::Eye eye;
  bool measured = false;  ///< the response as a calibration might find it, one dead channel
  std::string_view scene;
  double sigma = 0.0;  ///< of the noise on every sample, and for the rule of lambda
  recon::Objective objective;
  recon::Plan plan;
};

[[nodiscard]] std::vector<Case> golden_cases();

/// Sets the case up, solves its frame here and freezes it. Errors: those of the response, the scene and
/// Reconstructor::create().
[[nodiscard]] hal::Result<std::vector<std::byte>> frozen(const Case& golden);

}  // namespace compueye::golden
