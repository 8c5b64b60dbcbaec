#pragma once

#include <cstdint>

namespace compueye::tests {

/// Uses of the heap, counted since the program began. Linking the target `allocation_counter` replaces malloc and its
/// family, and with them operator new, in Release builds too; under a sanitizer, which has replaced them already, its
/// hooks are used instead. A reallocation counts as an allocation and a free.
struct HeapUse {
  std::uint64_t allocations = 0;
  std::uint64_t frees = 0;
  std::uint64_t bytes = 0;  ///< asked for, never given back

  [[nodiscard]] std::uint64_t calls() const noexcept { return allocations + frees; }
  friend HeapUse operator-(const HeapUse& a, const HeapUse& b) noexcept {
    return {a.allocations - b.allocations, a.frees - b.frees, a.bytes - b.bytes};
  }
};

/// By the calling thread: subtract two of them around the code that must not use the heap.
[[nodiscard]] HeapUse heap_use_of_this_thread() noexcept;

/// By all threads, for code that runs on threads a test cannot reach into.
[[nodiscard]] HeapUse heap_use_of_process() noexcept;

}  // namespace compueye::tests
