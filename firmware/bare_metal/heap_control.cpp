// Must not link: shows that the linker finds a use of the heap in an image that promises none. See CMakeLists.txt.
#include <cstdint>

#include "firmware/bare_metal/semihosting.hpp"

int main() {
  // A direct call: a new-expression may be optimised away.
  void* memory = ::operator new(64);
  compueye::bare_metal::write(static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(memory)));
  return 0;
}
