#include "firmware/operating_points/machine.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
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
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  if (!program || state == nullptr || XXH3_64bits_reset(state.get()) != XXH_OK) return "unknown";
  std::vector<char> chunk(1 << 20);
  while (program.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || program.gcount() > 0) {
    XXH3_64bits_update(state.get(), chunk.data(), static_cast<std::size_t>(program.gcount()));
  }
  return fmt::format("{:016x}", XXH3_64bits_digest(state.get()));
}

}  // namespace

Machine this_machine() {
  return {cpu_model(), static_cast<int>(std::thread::hardware_concurrency()), COMPUEYE_VERSION " " + program_hash()};
}

std::uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  std::uint64_t kib = 0;
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) kib = std::strtoull(line.c_str() + 6, nullptr, 10);
  }
  return kib * 1024;
}

}  // namespace compueye::firmware
