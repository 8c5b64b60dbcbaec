#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "hal/result.hpp"

namespace compueye::hal {

/// What a calibration found a channel to be. Only the rows of good ones reach a solver.
enum class ChannelStatus : std::uint8_t {
  good = 0,
  dead = 1,          ///< hardly answers to light
  hot = 2,           ///< far above the others in the dark
  noisy = 3,         ///< varies far more than its noise explains
  saturated = 4,     ///< at full scale under the light that it was measured with
  does_not_fit = 5,  ///< no response explains its samples of held-out patterns
  blind = 6,         ///< the drawing has it look past the light
};

struct NamedChannelStatus {
  std::string_view name;
  ChannelStatus status;
};

/// Every status there is, by its number.
[[nodiscard]] std::span<const NamedChannelStatus> channel_statuses() noexcept;
[[nodiscard]] std::string_view name(ChannelStatus status) noexcept;
/// The status with this number. Error out_of_range: there is none.
[[nodiscard]] Result<ChannelStatus> channel_status_of(int number);

}  // namespace compueye::hal
