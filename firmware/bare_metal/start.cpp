// What a Cortex-M does between power-on and main(): see boards/microcontrollers/sections.ld for the names.
#include <cstdint>

#include "firmware/bare_metal/semihosting.hpp"

extern "C" {
extern std::uint32_t stack_limit, stack_top, data_begin, data_end, data_image, bss_begin, bss_end;
[[noreturn]] void reset_handler() noexcept;
[[noreturn]] void fault_handler() noexcept;
}

int main();

namespace {

constexpr std::uint32_t faulted = 3;  // exit code

using Handler = void (*)() noexcept;

/// Stack pointer and the first fifteen exceptions of every Cortex-M (Armv7-M ARM, B1.5.3).
struct Vectors {
  std::uint32_t* stack;
  Handler handlers[15];
};
[[gnu::section(".vectors"), gnu::used]] const Vectors vectors{
    &stack_top,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler}};

/// Apart from the handler, so that no floating-point or vector instruction comes before the unit is on.
[[noreturn, gnu::noinline]] void run() noexcept {
  const std::uint32_t* from = &data_image;
  for (std::uint32_t* to = &data_begin; to < &data_end; ++to) *to = *from++;
  for (std::uint32_t* to = &bss_begin; to < &bss_end; ++to) *to = 0;
  compueye::bare_metal::leave(static_cast<std::uint32_t>(main()));
}

}  // namespace

void reset_handler() noexcept {
  auto* coprocessor_access = reinterpret_cast<volatile std::uint32_t*>(0xE000ED88);  // CPACR
  *coprocessor_access = *coprocessor_access | (0xFU << 20U);                         // CP10 and CP11: full access
  asm volatile("dsb\n\tisb" ::: "memory");
  run();
}

void fault_handler() noexcept {
  // The stack may be what has run out.
  asm volatile("msr msp, %0" ::"r"(&stack_top));
  compueye::bare_metal::write("fault: the program left its memory or overflowed its stack\n");
  compueye::bare_metal::leave(faulted);
}
