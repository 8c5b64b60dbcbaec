#pragma once

#include <filesystem>

#include "hal/result.hpp"

namespace compueye::firmware {

/// What `compueye replay` was asked for.
struct ReplayOptions {
  std::filesystem::path file;
  bool json = false;
};

/// Reads a whole recording and prints what it is, what is in it, which frames are missing and why, and what is damaged
/// or torn. A damaged recording is reported and no error; one whose header cannot be read is.
[[nodiscard]] hal::Result<void> replay(const ReplayOptions& options);

}  // namespace compueye::firmware
