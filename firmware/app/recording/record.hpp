#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "hal/result.hpp"

namespace compueye::firmware {

/// What `compueye record` was asked for.
struct RecordOptions {
  std::filesystem::path board;
  std::filesystem::path out;
  std::optional<std::int64_t> frames;  ///< 0: until stopped; absent, and no seconds: the board's frames_per_scene
  std::optional<double> seconds;
  std::string scene;  ///< empty: the board's
  std::int64_t scene_seed = 0;
  std::int64_t seed = 0;
  std::optional<double> distance_mm;
  std::optional<double> scene_distance_mm;
  bool lossless = false;  ///< frames as fast as they can be made and written, instead of at the board's rate
  bool json = false;

  /// Values out of range. Error usage names the option.
  [[nodiscard]] hal::Result<void> check() const;
};

/// Records a board's eye until there are enough frames, the time is over, the user stops it or the file fails; what was
/// recorded until then stays. Prints what is in the file.
[[nodiscard]] hal::Result<void> record(const RecordOptions& options);

}  // namespace compueye::firmware
