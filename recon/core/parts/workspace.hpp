#pragma once

#include <cstddef>
#include <cstdint>

namespace compueye::recon::core {

/// Hands out pieces of the caller's memory, one after the other, each 64-byte aligned. Made without memory it only
/// counts: the code that places a solver's vectors is the code that says how many bytes they need.
class Workspace {
 public:
  static constexpr std::size_t alignment = 64;

  Workspace() noexcept = default;
  /// `memory` must be aligned to `alignment`.
  explicit Workspace(std::byte* memory) noexcept : memory_(memory) {}

  template <class T>
  [[nodiscard]] T* take(std::size_t count) noexcept {
    T* piece = memory_ == nullptr ? nullptr : reinterpret_cast<T*>(memory_ + used_);
    used_ += (count * sizeof(T) + alignment - 1) / alignment * alignment;
    return piece;
  }

  [[nodiscard]] std::size_t used() const noexcept { return used_; }

 private:
  std::byte* memory_ = nullptr;
  std::size_t used_ = 0;
};

/// Base of what is made in memory that take() gave, because its members would fill a microcontroller's stack:
/// `new (place) Solver(...)`, never deleted, so it must not need a destructor.
struct MadeInWorkspace {
  static void* operator new(std::size_t, void* place) noexcept { return place; }
  static void operator delete(void*, void*) noexcept {}
};

}  // namespace compueye::recon::core
