#include "tests/firmware/sinks_allocation_count.hpp"

#include <atomic>
#include <cstddef>

namespace {
std::atomic<long> calls{0};
}

namespace compueye::test {
long allocations() {
  return calls.load();
}
}  // namespace compueye::test

// A definition in the program goes before the C library's, also for libpng and zlib.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);

void* malloc(std::size_t bytes) {
  ++calls;
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
  ++calls;
  return __libc_calloc(count, bytes);
}
void* realloc(void* memory, std::size_t bytes) {
  ++calls;
  return __libc_realloc(memory, bytes);
}
}
#endif
