#pragma once

#include <cstddef>
#include <cstdint>

extern "C" std::uint32_t stack_limit;  // boards/microcontrollers/sections.ld

namespace compueye::bare_metal {

/// How deep calls go: what lies below the stack pointer is painted, and where the paint is gone afterwards, calls were.
class PaintedStack {
 public:
  /// Paints from the stack's limit up to the caller's frame: inlined, so that it has no frame of its own.
  [[gnu::always_inline]] PaintedStack() noexcept {
    asm volatile("mov %0, sp" : "=r"(top_));
    // volatile, or the painting becomes a call of memset, which would paint its own frame.
    for (volatile std::uint32_t* word = &stack_limit; word < top_; ++word) *word = paint;
  }

  /// The most bytes that calls made since, from the same frame, have had on the stack.
  [[nodiscard]] std::size_t deepest() const noexcept {
    const volatile std::uint32_t* word = &stack_limit;
    while (word < top_ && *word == paint) ++word;
    return static_cast<std::size_t>(top_ - word) * sizeof(std::uint32_t);
  }

 private:
  static constexpr std::uint32_t paint = 0x5AC0FFEE;
  const volatile std::uint32_t* top_;
};

}  // namespace compueye::bare_metal
