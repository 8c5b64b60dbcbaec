#include "hal/channel_status.hpp"

#include <array>
#include <cstddef>
#include <string>

namespace compueye::hal {
namespace {

constexpr std::array<NamedChannelStatus, 7> statuses{{
    {"good", ChannelStatus::good},
    {"dead", ChannelStatus::dead},
    {"hot", ChannelStatus::hot},
    {"noisy", ChannelStatus::noisy},
    {"saturated", ChannelStatus::saturated},
    {"does-not-fit", ChannelStatus::does_not_fit},
    {"blind", ChannelStatus::blind},
}};

}  // namespace

std::span<const NamedChannelStatus> channel_statuses() noexcept {
  return statuses;
}

std::string_view name(ChannelStatus status) noexcept {
  const auto number = static_cast<std::size_t>(status);
  return number < statuses.size() ? statuses[number].name : "unknown";
}

Result<ChannelStatus> channel_status_of(int number) {
  if (number >= 0 && static_cast<std::size_t>(number) < statuses.size()) {
    return statuses[static_cast<std::size_t>(number)].status;
  }
  return fail(ErrorCode::out_of_range, "channel status",
              "is " + std::to_string(number) + ", expected 0 to " + std::to_string(statuses.size() - 1));
}

}  // namespace compueye::hal
