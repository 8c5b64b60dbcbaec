#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace compueye::protocol {

/// What an emulated device can be made to do wrong.
enum class FaultKind : std::uint8_t {
  silence,            ///< nothing comes out of the stream for duration_ns; 0: until STOP or RESET_PIPES
  control_silence,    ///< requests are not answered for duration_ns; 0: until the bus is reset
  stall_stream,       ///< the stream's endpoint is halted until RESET_PIPES
  stall_control,      ///< the next `count` requests are stalled; 0: until the bus is reset
  short_read,         ///< the next `count` packets (reports) end in the middle
  bit_error,          ///< one bit of each of the next `count` packets (reports) is turned
  wrong_echo,         ///< the next `count` GET_CONFIG return another exposure than was set
  unplug,             ///< gone; comes back after duration_ns as after power-on, 0: never
  replug_other,       ///< gone; after duration_ns another device with serial `text` is there
  clock_jump,         ///< the device clock steps by `value` ns; the next frame has no TIME_OK
  reboot,             ///< the firmware starts anew in mid-frame. `value` 1: and streams at once, unasked, config_id 0
  babble,             ///< garbage as fast as the link goes for duration_ns; 0: until the bus is reset or power is cut
  other_version,      ///< from now on it is a device of protocol version byte `value`
  lose_packets,       ///< the next `count` packets (reports) are lost on the way
  duplicate_packets,  ///< the next `count` packets (reports) come twice
  overrun,            ///< the next `count` frames do not fit the device's memory
  lose_answers,       ///< the next `count` requests are carried out, and the host gets no answer
};
inline constexpr std::size_t fault_kind_count = static_cast<std::size_t>(FaultKind::lose_answers) + 1;

[[nodiscard]] std::string_view name(FaultKind kind) noexcept;

/// One line of a script: a fault and when. `at_frame`: when the device exposes this frame of a stream (once); otherwise
/// at emulator time `at_ns`. Write it with designated initialisers: {.kind = FaultKind::silence, .duration_ns =
/// 5'000'000}.
struct EmulatorFault {
  FaultKind kind = FaultKind::silence;
  std::int64_t at_ns = 0;
  std::optional<std::uint64_t> at_frame = std::nullopt;
  std::int64_t duration_ns = 0;
  std::uint64_t count = 1;
  std::int64_t value = 0;
  std::string text = {};
};

}  // namespace compueye::protocol
