#include "tests/memory/allocation_counter.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <thread>
#include <vector>

using compueye::tests::heap_use_of_process;
using compueye::tests::heap_use_of_this_thread;
using compueye::tests::HeapUse;

namespace {

// Through a volatile pointer, because a compiler may leave out an allocation that nobody looks at.
void* volatile seen = nullptr;

template <class Allocate, class Release>
HeapUse use_of(Allocate allocate, Release release) {
  const HeapUse before = heap_use_of_this_thread();
  seen = allocate();
  release(seen);
  return heap_use_of_this_thread() - before;
}

struct alignas(128) Wide {
  char bytes[256];
};

}  // namespace

TEST_CASE("every way to the heap is counted") {
  const auto free_it = [](void* p) { std::free(p); };
  CHECK(use_of([] { return std::malloc(10); }, free_it).bytes == 10);
  CHECK(use_of([] { return std::malloc(10); }, free_it).calls() == 2);
  CHECK(use_of([] { return std::calloc(3, 7); }, free_it).bytes == 21);
  CHECK(use_of([] { return std::realloc(std::malloc(8), 80); }, free_it).allocations == 2);
  // A thread sanitizer tells its hooks of the release of aligned memory, not of the allocation.
  const auto by_posix = [] {
    void* p = nullptr;
    return posix_memalign(&p, 64, 100) == 0 ? p : nullptr;
  };
  const HeapUse aligned = use_of([] { return std::aligned_alloc(64, 128); }, free_it);
  const HeapUse posix_aligned = use_of(by_posix, free_it);
  CHECK(aligned.frees == 1);
  CHECK(posix_aligned.frees == 1);
#if !defined(COMPUEYE_THREAD_SANITIZED)
  CHECK(aligned.allocations == 1);
  CHECK(posix_aligned.bytes == 100);
#endif
  CHECK(use_of([] { return static_cast<void*>(strdup("inside the C library")); }, free_it).calls() == 2);
  CHECK(use_of([] { return static_cast<void*>(new int(3)); }, [](void* p) { delete static_cast<int*>(p); }).calls() ==
        2);
  CHECK(use_of([] { return static_cast<void*>(new Wide()); }, [](void* p) { delete static_cast<Wide*>(p); }).calls() ==
        2);
  CHECK(use_of([] { return static_cast<void*>(new (std::nothrow) char[9]); },
               [](void* p) { delete[] static_cast<char*>(p); })
            .calls() == 2);
}

TEST_CASE("arithmetic on a ready vector is not a use of the heap") {
  std::vector<int> numbers(100, 1);
  const HeapUse before = heap_use_of_this_thread();
  for (int& n : numbers) n *= 2;
  numbers.clear();
  numbers.resize(50);
  const HeapUse used = heap_use_of_this_thread() - before;
  CHECK(used.calls() == 0);
  CHECK(numbers.size() == 50);
}

TEST_CASE("another thread is counted for the process only") {
  const HeapUse mine_before = heap_use_of_this_thread();
  HeapUse theirs;
  HeapUse whole;
  {
    std::thread other([&] {
      const HeapUse before = heap_use_of_this_thread();
      const HeapUse whole_before = heap_use_of_process();
      seen = std::malloc(1000);
      std::free(seen);
      theirs = heap_use_of_this_thread() - before;
      whole = heap_use_of_process() - whole_before;
    });
    other.join();
  }
  CHECK(theirs.allocations == 1);
  CHECK(theirs.frees == 1);
  CHECK(whole.bytes >= 1000);
  CHECK((heap_use_of_this_thread() - mine_before).bytes < 1000);
}
