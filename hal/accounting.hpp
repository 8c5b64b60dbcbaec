#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace compueye::hal {

/// Why a frame that a device produced never became a picture. One counter each; there is no "other".
enum class DropReason : std::uint8_t {
  device_overrun,    ///< the device's own buffer overflowed before the host read it (seen as a sequence gap)
  transport_gap,     ///< lost on the way (sequence gap without the device's overrun flag)
  corrupt,           ///< CRC, length or configuration echo wrong
  too_few_channels,  ///< more channels invalid than the board's stated share
  superseded,        ///< a newer frame arrived while this one waited for the solver (newest wins)
  solver_invalid,    ///< the solver reported an unusable result
  sink_failed,       ///< the sink refused the frame
  stopped,           ///< still in a queue when the run was stopped
};
inline constexpr std::size_t drop_reason_count = static_cast<std::size_t>(DropReason::stopped) + 1;

[[nodiscard]] std::string_view name(DropReason reason) noexcept;

/// The bookkeeping every stage keeps: nothing may vanish.
struct FrameAccount {
  std::uint64_t produced = 0;
  std::uint64_t delivered = 0;
  std::array<std::uint64_t, drop_reason_count> dropped{};
  /// Of the dropped ones, those that nobody has counted: the device forgot or could not be asked, and so many follow
  /// from its rate and the time.
  std::uint64_t estimated = 0;
  /// Of the eye under a check's light and not of its scene: neither delivered nor lost.
  std::uint64_t checked = 0;

  std::uint64_t& drops(DropReason reason) noexcept { return dropped[static_cast<std::size_t>(reason)]; }
  [[nodiscard]] std::uint64_t drops(DropReason reason) const noexcept {
    return dropped[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] std::uint64_t total_dropped() const noexcept;
  /// produced = delivered + sum(dropped) + checked
  [[nodiscard]] bool balanced() const noexcept { return produced == delivered + total_dropped() + checked; }
};

}  // namespace compueye::hal
