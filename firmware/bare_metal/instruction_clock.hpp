#pragma once

#include <cstdint>

namespace compueye::bare_metal {

/// SysTick, counting the processor's clock down from 2^24 - 1 (Armv7-M ARM, B3.3). Under QEMU with -icount shift=0 an
/// instruction takes a nanosecond of that clock, so that ticks are instructions; on hardware they are cycles.
class InstructionClock {
 public:
  void start() const noexcept {
    *reload = most;
    *current = 0;
    *control = enabled_by_processor_clock;
  }

  /// Ticks since start(), at most 2^24 - 1.
  [[nodiscard]] std::uint32_t ticks() const noexcept { return most - *current; }
  /// Whether more have gone by than it can count.
  [[nodiscard]] bool ran_over() const noexcept { return (*control & counted_to_zero) != 0; }

 private:
  static constexpr std::uint32_t most = 0x00FFFFFF;
  static constexpr std::uint32_t enabled_by_processor_clock = 5;
  static constexpr std::uint32_t counted_to_zero = 1U << 16U;
  volatile std::uint32_t* const control = reinterpret_cast<volatile std::uint32_t*>(0xE000E010);
  volatile std::uint32_t* const reload = reinterpret_cast<volatile std::uint32_t*>(0xE000E014);
  volatile std::uint32_t* const current = reinterpret_cast<volatile std::uint32_t*>(0xE000E018);
};

}  // namespace compueye::bare_metal
