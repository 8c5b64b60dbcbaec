#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "hal/result.hpp"

namespace compueye::firmware {

/// What `compueye simulate` was asked for.
struct SimulateOptions {
  std::filesystem::path board;
  std::string scene;  ///< empty: the board's
  std::int64_t scene_seed = 0;
  std::filesystem::path out;  ///< y.npy
  std::int64_t frames = 1;
  std::int64_t seed = 0;
  std::optional<double> distance_mm;
  std::optional<double> scene_distance_mm;
  bool noise_free = false;
  bool codes = false;
  std::filesystem::path truth;
  std::filesystem::path weights;
  bool explain = false;
  bool json = false;
};

/// Writes the samples of a board's simulated eye: float32, (M,) for one frame and (frames, M) for more, by ommatidium,
/// in units of one fully seen white pixel with dark level and LSB taken out; channels that tell nothing are NaN.
[[nodiscard]] hal::Result<void> simulate(const SimulateOptions& options);

}  // namespace compueye::firmware
