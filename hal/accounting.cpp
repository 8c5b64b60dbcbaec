#include "hal/accounting.hpp"

#include <numeric>

namespace compueye::hal {

std::string_view name(DropReason reason) noexcept {
  switch (reason) {
    case DropReason::device_overrun:
      return "device overrun";
    case DropReason::transport_gap:
      return "transport gap";
    case DropReason::corrupt:
      return "corrupt";
    case DropReason::too_few_channels:
      return "too few channels";
    case DropReason::superseded:
      return "superseded";
    case DropReason::solver_invalid:
      return "solver invalid";
    case DropReason::sink_failed:
      return "sink failed";
    case DropReason::stopped:
      return "stopped";
  }
  return "unknown";
}

std::uint64_t FrameAccount::total_dropped() const noexcept {
  return std::accumulate(dropped.begin(), dropped.end(), std::uint64_t{0});
}

}  // namespace compueye::hal
