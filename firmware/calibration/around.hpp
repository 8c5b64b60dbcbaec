#pragma once

#include <cstdint>

namespace compueye::firmware {

/// What an eye sees while the light of a check is off.
enum class Around : std::uint8_t {
  dark,   ///< nothing, as in its session
  scene,  ///< light of its own: still while the check lasts, it is taken off, and dark levels are not judged
};

}  // namespace compueye::firmware
