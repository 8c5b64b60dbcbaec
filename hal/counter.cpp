#include "hal/counter.hpp"

namespace compueye::hal {

std::uint64_t faults_in(std::span<const Counter> counters) noexcept {
  std::uint64_t faults = 0;
  for (const Counter& each : counters) faults += each.fault ? each.count : 0;
  return faults;
}

std::string text_of(std::span<const Counter> counters) {
  std::string text;
  for (const Counter& each : counters) {
    if (each.count == 0) continue;
    if (!text.empty()) text += ", ";
    text += std::string(each.name) + ' ' + std::to_string(each.count);
  }
  return text;
}

}  // namespace compueye::hal
