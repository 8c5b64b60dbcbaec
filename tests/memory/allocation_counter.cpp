#include "tests/memory/allocation_counter.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace compueye::tests {
namespace {

// Constant-initialised, because the first malloc comes before any constructor.
thread_local HeapUse of_thread;
std::atomic<std::uint64_t> allocations{0};
std::atomic<std::uint64_t> frees{0};
std::atomic<std::uint64_t> bytes{0};

void count_allocation(std::size_t size) noexcept {
  ++of_thread.allocations;
  of_thread.bytes += size;
  allocations.fetch_add(1, std::memory_order_relaxed);
  bytes.fetch_add(size, std::memory_order_relaxed);
}

void count_free() noexcept {
  ++of_thread.frees;
  frees.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

HeapUse heap_use_of_this_thread() noexcept {
  return of_thread;
}
HeapUse heap_use_of_process() noexcept {
  return {allocations.load(), frees.load(), bytes.load()};
}

}  // namespace compueye::tests

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define COMPUEYE_SANITIZER_ALLOCATES
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define COMPUEYE_SANITIZER_ALLOCATES
#endif
#endif

#ifdef COMPUEYE_SANITIZER_ALLOCATES

// Declared here because GCC does not install the sanitizers' allocator_interface.h.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                                         void (*on_free)(const volatile void*));

namespace {
[[maybe_unused]] const int hooks_installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) { compueye::tests::count_allocation(size); },
    [](const volatile void*) { compueye::tests::count_free(); });
}  // namespace

#else

// The C library lets a program bring its own malloc family and keeps the original under these names, so that every
// caller is counted, the C++ and C libraries included. operator new comes here through malloc.
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  compueye::tests::count_allocation(size);
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  compueye::tests::count_allocation(count * size);
  return __libc_calloc(count, size);
}

void* realloc(void* memory, std::size_t size) {
  compueye::tests::count_allocation(size);
  if (memory != nullptr) compueye::tests::count_free();
  return __libc_realloc(memory, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  compueye::tests::count_allocation(size);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  compueye::tests::count_allocation(size);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  compueye::tests::count_allocation(size);
  void* const got = __libc_memalign(alignment, size);
  if (got == nullptr) return ENOMEM;
  *memory = got;
  return 0;
}

void free(void* memory) {
  if (memory != nullptr) compueye::tests::count_free();
  __libc_free(memory);
}

}  // extern "C"

#endif
