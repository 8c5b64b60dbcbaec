// Board files: TOML from anybody.

#include <string>

#include "tests/firmware/app_board_promises.hpp"
#include "tests/fuzz/invariant.hpp"

using namespace compueye;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string broken = firmware::test::broken_promise(std::string(reinterpret_cast<const char*>(data), size));
  fuzz::invariant(broken.empty(), broken.c_str());
  return 0;
}
