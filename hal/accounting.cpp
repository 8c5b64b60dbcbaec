#include "hal/accounting.hpp"

#include <array>
#include <numeric>

namespace compueye::hal {

std::string_view name(DropReason reason) noexcept {
  constexpr std::array<std::string_view, drop_reason_count> names{"device overrun",   "transport gap", "corrupt",
                                                                  "too few channels", "superseded",    "solver invalid",
                                                                  "sink failed",      "stopped"};
  static_assert(!names.back().empty());
  const auto k = static_cast<std::size_t>(reason);
  return k < names.size() ? names[k] : "unknown";
}

std::uint64_t FrameAccount::total_dropped() const noexcept {
  return std::accumulate(dropped.begin(), dropped.end(), std::uint64_t{0});
}

}  // namespace compueye::hal
