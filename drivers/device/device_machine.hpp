#pragma once

#include <cstdint>
#include <string_view>

#include "drivers/device/back_off.hpp"
#include "drivers/device/failure_counters.hpp"

namespace compueye::device {

/// Where an eye is on its way to frames: RESET -> WAIT -> IDENTIFY -> CONFIGURE -> READ.
enum class MachineState : std::uint8_t {
  reset,      ///< RESET: open it, end whatever it does
  wait,       ///< WAIT: the pause after a failure; then until it answers
  identify,   ///< IDENTIFY: is it ours, has it started anew, what is it
  configure,  ///< CONFIGURE: set, compare, start
  read,       ///< READ: frames come
  given_up,   ///< nothing more is tried
};
[[nodiscard]] std::string_view name(MachineState state) noexcept;

/// What the machine wants done next.
enum class Order : std::uint8_t {
  open,
  reset_pipes,
  pause,  ///< until DeviceMachine::resume_ns()
  ping,
  status,
  descriptor,
  set_config,
  get_config,
  start,
  read,
  none,  ///< given up
};

/// The machine of every eye, without the eye: told what worked and what failed and when, it says what to do next.
///
/// - A failure in READ leads to RESET at once; every other one first to a pause in WAIT that doubles.
/// - The first attempt after a stream failed keeps the device open (RESET_PIPES); whatever fails then, and every
/// request
///   that fails, has it closed and opened again, which resets the bus.
/// - A device that is given up in READ is left open, so that it can be asked about its stream.
/// - An outage lasts from the failure in READ to the next frame. It is given up when an attempt fails after
///   `limit_ns`; at once when that is 0. Another protocol version or another descriptor is given up at once, a wrong
///   echo when it came `echo_tries` times without a right one.
class DeviceMachine {
 public:
  static constexpr int echo_tries = 3;

  explicit DeviceMachine(const BackOffSettings& back_off) noexcept : back_off_(back_off) {}

  /// To RESET, with `limit_ns` from now on.
  void begin(std::int64_t now_ns, std::int64_t limit_ns) noexcept;
  /// What outages may last from now on; there is none now.
  void run_with(std::int64_t limit_ns) noexcept;

  [[nodiscard]] Order next(std::int64_t now_ns) noexcept;
  void done(Order order, std::int64_t now_ns) noexcept;
  void failed(Failure why, std::int64_t now_ns) noexcept;
  /// A frame came: the outage, if there was one, is over.
  void saw_frame() noexcept;
  /// Given up, and the device is no longer needed.
  void close() noexcept { open_ = false; }
  /// The descriptor has to be fetched again.
  void doubt_identity() noexcept { identified_ = false; }

  [[nodiscard]] MachineState state() const noexcept { return state_; }
  [[nodiscard]] std::int64_t resume_ns() const noexcept { return resume_ns_; }
  /// How long no frame has come, since the failure in READ; 0 when there is no outage.
  [[nodiscard]] bool in_outage() const noexcept { return outage_; }
  [[nodiscard]] std::int64_t outage_ns(std::int64_t now_ns) const noexcept { return outage_ ? now_ns - outage_ns_ : 0; }
  /// Whether the device is to be held open.
  [[nodiscard]] bool is_open() const noexcept { return open_; }

 private:
  BackOff back_off_;
  MachineState state_ = MachineState::reset;
  Order step_ = Order::status;  // of IDENTIFY and CONFIGURE
  bool open_ = false;
  bool identified_ = false;
  bool reset_after_pause_ = false;
  std::int64_t resume_ns_ = 0;

  std::int64_t limit_ns_ = 0;
  bool outage_ = false;
  std::int64_t outage_ns_ = 0;  // when it began
  int attempts_ = 0;            // that failed since the last frame
  int wrong_echoes_ = 0;
};

}  // namespace compueye::device
