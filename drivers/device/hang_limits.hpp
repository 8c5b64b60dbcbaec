#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace compueye::device {

/// What a HangProofSource calls its device for. A driver may not come back from any of them.
enum class DeviceCall : std::uint8_t { open, start, read, set, stop, close };

/// A row a call: how long it is waited for, and what becomes of it then.
struct HangLimit {
  DeviceCall call;
  std::string_view name;
  std::int64_t budget_ns;  ///< of read: behind its deadline
  std::string_view then;   ///< for docs/faults.md
};

inline constexpr std::array<HangLimit, 6> hang_limits{{
    {DeviceCall::open, "open", 10'000'000'000, "there is no eye: the command ends, and says so"},
    {DeviceCall::start, "start", 5'000'000'000, "no run begins, and an error says so"},
    {DeviceCall::read, "read", 500'000'000, "`read()` has timed out, and the source is recovering"},
    {DeviceCall::set, "set", 2'000'000'000, "exposure, lamp or GPIO lamps are not set, and an error says so"},
    {DeviceCall::stop, "stop", 2'000'000'000, "the run ends without it, and says so"},
    {DeviceCall::close, "close", 1'000'000'000, "the program goes on, or ends, without it"},
}};

[[nodiscard]] constexpr const HangLimit& limit_of(DeviceCall call) noexcept {
  return hang_limits[static_cast<std::size_t>(call)];
}

/// read() answers so long after its deadline at most: a driver that is as late as that does not hang.
inline constexpr std::int64_t latest_answer_ns = 10'000'000;
/// A read that is not back so long after its deadline will not come back: the stream is over.
inline constexpr std::int64_t hang_given_up_after_ns = 10'000'000'000;

/// The table of docs/faults.md.
[[nodiscard]] std::string hang_reference();

}  // namespace compueye::device
