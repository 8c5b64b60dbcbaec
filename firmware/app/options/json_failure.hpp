#pragma once

#include "hal/result.hpp"

namespace compueye::firmware {

/// With `json`, a failure is also printed to stdout as an object, so that a program reads one either way. Returns
/// `done`.
[[nodiscard]] hal::Result<void> with_json_failure(bool json, hal::Result<void> done);

}  // namespace compueye::firmware
