#pragma once

#include <cstdint>

namespace compueye::bare_metal {

// Words to the debugger, or to QEMU, that holds this processor (Arm, "Semihosting for AArch32 and AArch64", 2023).
// Without one they fault.

/// Writes text, which ends with a zero.
void write(const char* text) noexcept;
/// Writes a number in decimal.
void write(std::uint32_t number) noexcept;

/// Ends the program; QEMU exits with this code.
[[noreturn]] void leave(std::uint32_t exit_code) noexcept;

}  // namespace compueye::bare_metal
