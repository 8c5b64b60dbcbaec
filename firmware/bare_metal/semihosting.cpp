#include "firmware/bare_metal/semihosting.hpp"

namespace compueye::bare_metal {
namespace {

constexpr std::uint32_t sys_write0 = 0x04;
constexpr std::uint32_t sys_exit_extended = 0x20;
constexpr std::uint32_t application_exit = 0x20026;

void call(std::uint32_t operation, const void* argument) noexcept {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

}  // namespace

void write(const char* text) noexcept {
  call(sys_write0, text);
}

void write(std::uint32_t number) noexcept {
  char digits[11] = {};
  char* first = digits + sizeof digits - 1;
  do {
    *--first = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number > 0);
  write(first);
}

void leave(std::uint32_t exit_code) noexcept {
  const std::uint32_t reason[2] = {application_exit, exit_code};
  call(sys_exit_extended, reason);
  for (;;) {
  }
}

}  // namespace compueye::bare_metal
