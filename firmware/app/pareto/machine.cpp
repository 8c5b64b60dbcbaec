#include "firmware/app/pareto/machine.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string_view>
#include <thread>
#include <vector>

#include "xxhash.h"

namespace compueye::firmware {
namespace {

/// What x86 calls "model name" some boards tell as "Model" or "Hardware".
std::string cpu_model() {
  constexpr std::array<std::string_view, 3> keys{"model name", "Model", "Hardware"};
  std::ifstream info("/proc/cpuinfo");
  std::array<std::string, keys.size()> found;
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || colon + 2 > line.size()) continue;
    for (std::size_t k = 0; k < keys.size(); ++k) {
      if (found[k].empty() && line.rfind(keys[k], 0) == 0) found[k] = line.substr(colon + 2);
    }
  }
  for (const std::string& model : found) {
    if (!model.empty()) return model;
  }
  return "unknown processor";
}

/// Another build may be faster or slower, whatever its version says.
std::string program_hash() {
  std::ifstream program("/proc/self/exe", std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(program), {}};
  return bytes.empty() ? "unknown" : fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
}

}  // namespace

Machine this_machine() {
  return {cpu_model(), static_cast<int>(std::thread::hardware_concurrency()), COMPUEYE_VERSION " " + program_hash()};
}

}  // namespace compueye::firmware
