#pragma once

#include <cstdint>
#include <string>

#include "firmware/eye/board.hpp"
#include "hal/clock.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// What a recording's header says, for people: lines "key = value". Of an eye on a cable nobody knows the scene.
struct RecordedWith {
  std::string scene;
  std::int64_t scene_seed = 0;
  std::int64_t seed = 0;

  [[nodiscard]] std::string text(const Board& board) const;
};

/// Wall clock minus `clock`, for RecordingSettings.
[[nodiscard]] std::int64_t unix_minus(const hal::Clock& clock);

/// Whether a recording can be begun at `path`, so that it is known before the set-up and not after. Errors: io (there
/// is one already), not_found (no such folder).
[[nodiscard]] hal::Result<void> check_new_recording(const std::string& path);

}  // namespace compueye::firmware
