#include "drivers/device/device_machine.hpp"

#include <array>
#include <cstddef>

namespace compueye::device {

std::string_view name(MachineState state) noexcept {
  constexpr std::array<std::string_view, 6> names{"RESET", "WAIT", "IDENTIFY", "CONFIGURE", "READ", "GIVEN UP"};
  return names[static_cast<std::size_t>(state)];
}

void DeviceMachine::begin(std::int64_t now_ns, std::int64_t limit_ns) noexcept {
  saw_frame();
  state_ = MachineState::reset;
  limit_ns_ = limit_ns;
  outage_ = true;
  outage_ns_ = now_ns;
}

void DeviceMachine::run_with(std::int64_t limit_ns) noexcept {
  saw_frame();
  limit_ns_ = limit_ns;
}

void DeviceMachine::saw_frame() noexcept {
  outage_ = false;
  attempts_ = wrong_echoes_ = 0;
  back_off_.reset();
}

Order DeviceMachine::next(std::int64_t now_ns) noexcept {
  if (state_ == MachineState::wait && now_ns >= resume_ns_ && reset_after_pause_) state_ = MachineState::reset;
  switch (state_) {
    case MachineState::reset:
      return open_ ? Order::reset_pipes : Order::open;
    case MachineState::wait:
      return now_ns < resume_ns_ ? Order::pause : Order::ping;
    case MachineState::identify:
    case MachineState::configure:
      return step_;
    case MachineState::read:
      return Order::read;
    case MachineState::given_up:
      break;
  }
  return Order::none;
}

void DeviceMachine::done(Order order, std::int64_t now_ns) noexcept {
  const auto go = [&](MachineState state, Order step) {
    state_ = state;
    step_ = step;
  };
  switch (order) {
    case Order::open:
      open_ = true;
      identified_ = false;
      return;
    case Order::reset_pipes:
      reset_after_pause_ = false;
      resume_ns_ = now_ns;
      return go(MachineState::wait, Order::ping);
    case Order::ping:
      return go(MachineState::identify, Order::status);
    case Order::status:
      if (!identified_) return go(MachineState::identify, Order::descriptor);
      return go(MachineState::configure, Order::set_config);
    case Order::descriptor:
      identified_ = true;
      return go(MachineState::configure, Order::set_config);
    case Order::set_config:
      return go(MachineState::configure, Order::get_config);
    case Order::get_config:
      wrong_echoes_ = 0;
      return go(MachineState::configure, Order::start);
    case Order::start:
      return go(MachineState::read, Order::read);
    case Order::pause:
    case Order::read:
    case Order::none:
      return;
  }
}

void DeviceMachine::failed(Failure why, std::int64_t now_ns) noexcept {
  if (state_ == MachineState::given_up) return;
  if (!outage_) {
    outage_ = true;
    outage_ns_ = now_ns;
  }
  if (why == Failure::wrong_echo && ++wrong_echoes_ < echo_tries && limit_ns_ > 0) {
    step_ = Order::set_config;
    return;
  }
  ++attempts_;
  const bool was_reading = state_ == MachineState::read;
  const bool at_once = was_reading && attempts_ == 1;
  const bool hopeless = why == Failure::other_version || why == Failure::other_descriptor || why == Failure::wrong_echo;
  const bool too_long = limit_ns_ == 0 || (now_ns - outage_ns_ >= limit_ns_ && !at_once);
  if (why == Failure::unplugged || !was_reading) open_ = false;
  if (hopeless || too_long) {
    state_ = MachineState::given_up;
    return;
  }
  if (at_once) {
    state_ = MachineState::reset;
    return;
  }
  open_ = false;
  state_ = MachineState::wait;
  reset_after_pause_ = true;
  resume_ns_ = now_ns + back_off_.next_ns();
}

}  // namespace compueye::device
