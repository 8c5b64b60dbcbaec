#pragma once

namespace compueye::test {

/// Whether a sanitizer looks on, which makes everything five to fifty times slower: what it is to see is every line and
/// every kind of case, not every digit.
#if defined(COMPUEYE_SANITIZED)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace compueye::test
