#include "drivers/protocol/emulated_transport.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "drivers/protocol/hid_control.hpp"
#include "hal/try.hpp"

namespace compueye::protocol {

EmulatedTransport::EmulatedTransport(DeviceEmulator& device, hal::Clock& clock) : device_(device), clock_(clock) {
  description_.bus = "emulator " + std::string(device.bus().name);
  description_.serial = device.serial();
  description_.max_packet = device.bus().emulated_max_packet_bytes;
}

hal::Result<void> EmulatedTransport::open() {
  const std::int64_t now_ns = clock_.now_ns();
  if (!device_.attached(now_ns)) {
    return hal::fail(hal::ErrorCode::not_found, description_.bus, "no eye is plugged in; plug it in");
  }
  device_.reset_bus(now_ns);
  attachment_ = device_.attachment(now_ns);
  description_.serial = device_.serial();
  return {};
}

tl::unexpected<hal::Error> EmulatedTransport::gone() const {
  return hal::fail(hal::ErrorCode::disconnected, description_.serial, "the eye was unplugged; plug it in again");
}

hal::Result<void> EmulatedTransport::check_there() {
  if (attachment_ == 0) {
    return hal::fail(hal::ErrorCode::usage, description_.bus, "the transport is not open; call open() first");
  }
  const std::int64_t now_ns = clock_.now_ns();
  if (!device_.attached(now_ns) || device_.attachment(now_ns) != attachment_) return gone();
  return {};
}

hal::Result<std::size_t> EmulatedTransport::read(std::span<std::byte> into, std::int64_t deadline_ns) {
  for (;;) {
    TRY(check_there());
    const std::int64_t now_ns = clock_.now_ns();
    const DeviceEmulator::Transfer transfer = device_.read(now_ns, into);
    if (transfer.outcome != DeviceEmulator::Outcome::nothing) return outcome(transfer, "the stream", deadline_ns);
    if (now_ns >= deadline_ns) return hal::timed_out();
    clock_.sleep_until_ns(std::min(device_.next_change_ns(now_ns).value_or(deadline_ns), deadline_ns));
  }
}

hal::Result<std::size_t> EmulatedTransport::control(std::uint8_t request, std::span<const std::byte> payload,
                                                    std::span<std::byte> reply, std::int64_t deadline_ns) {
  TRY(check_there());
  const std::int64_t answered_ns = clock_.now_ns() + control_ns;
  clock_.sleep_until_ns(std::min(answered_ns, deadline_ns));
  if (answered_ns > deadline_ns) return hal::timed_out();
  TRY(check_there());
  if (device_.bus().framing == Framing::reports) return feature_reports(request, payload, reply, deadline_ns);
  return outcome(device_.control(clock_.now_ns(), request, payload, reply), "a request", deadline_ns);
}

hal::Result<std::size_t> EmulatedTransport::feature_reports(std::uint8_t request, std::span<const std::byte> payload,
                                                            std::span<std::byte> reply, std::int64_t deadline_ns) {
  const auto exchange = TRY(hid_exchange(request, payload, reply.size()));
  if (exchange.has_set) {
    TRY(outcome(device_.set_feature(clock_.now_ns(), exchange.set), "a feature report", deadline_ns));
  }
  if (!exchange.has_get) return std::size_t{0};
  HidReportBytes report{};
  auto got = TRY(outcome(device_.get_feature(clock_.now_ns(), static_cast<std::uint8_t>(exchange.get), report),
                         "a feature report", deadline_ns));
  return hid_reply(request, payload, std::span<const std::byte>(report).first(got), reply);
}

hal::Result<std::size_t> EmulatedTransport::outcome(DeviceEmulator::Transfer transfer, const char* what,
                                                    std::int64_t deadline_ns) {
  switch (transfer.outcome) {
    case DeviceEmulator::Outcome::done:
      return transfer.bytes;
    case DeviceEmulator::Outcome::nothing:
      return wait_in_vain(deadline_ns);
    case DeviceEmulator::Outcome::stalled:
      return hal::fail(hal::ErrorCode::io, description_.serial,
                       std::string("the device stalled ") + what + "; reset its pipes or open it again");
    case DeviceEmulator::Outcome::gone:
      break;
  }
  return gone();
}

/// No answer will come; an unplugging ends the wait, as it does on a real bus.
tl::unexpected<hal::Error> EmulatedTransport::wait_in_vain(std::int64_t deadline_ns) {
  for (;;) {
    TRY(check_there());
    const std::int64_t now_ns = clock_.now_ns();
    if (now_ns >= deadline_ns) return hal::timed_out();
    clock_.sleep_until_ns(std::min(device_.next_change_ns(now_ns).value_or(deadline_ns), deadline_ns));
  }
}

}  // namespace compueye::protocol
