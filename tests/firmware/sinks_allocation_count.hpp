#pragma once

namespace compueye::test {

/// Calls of malloc, calloc, realloc and operator new by the whole process, libraries included, so far.
[[nodiscard]] long allocations();

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool counts_allocations = false;
#else
inline constexpr bool counts_allocations = true;
#endif

}  // namespace compueye::test
