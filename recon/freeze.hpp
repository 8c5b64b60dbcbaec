#pragma once

#include <cstddef>
#include <vector>

#include "recon/core/parts/frozen_frame.hpp"

namespace compueye::recon {

/// The bytes that core::thaw() reads: every number and table of the frame, wherever its pointers lead.
[[nodiscard]] std::vector<std::byte> freeze(core::FrozenFrame frame);

}  // namespace compueye::recon
