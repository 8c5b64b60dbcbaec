#pragma once

#include <cstdio>
#include <cstdlib>

namespace compueye::fuzz {

/// What must hold whatever the input is. Ends the program otherwise, which is what a fuzzer looks for.
inline void invariant(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

}  // namespace compueye::fuzz
