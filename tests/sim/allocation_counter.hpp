#pragma once

#include <cstddef>

namespace compueye::testing {

/// Calls of operator new by this process so far, in every build type.
[[nodiscard]] std::size_t allocations() noexcept;

}  // namespace compueye::testing
