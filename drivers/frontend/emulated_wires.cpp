#include "drivers/frontend/emulated_wires.hpp"

#include <algorithm>

namespace compueye::frontend {
namespace {

using hal::ErrorCode;

tl::unexpected<hal::Error> not_open(const std::string& name) {
  return hal::fail(ErrorCode::usage, name, "is not open; call open() first");
}

tl::unexpected<hal::Error> gone(const std::string& name) {
  return hal::fail(ErrorCode::disconnected, name, "is gone");
}

tl::unexpected<hal::Error> not_there(const std::string& name) {
  return hal::fail(ErrorCode::not_found, name, "is not there");
}

}  // namespace

EmulatedSpiBus::EmulatedSpiBus(EmulatedFrontEnd& front_end, hal::Clock& clock, bool settings)
    : front_end_(front_end), clock_(clock), settings_(settings) {
  description_.name = settings ? "emulated settings" : "emulated spi";
  description_.most_bytes = static_cast<std::size_t>(front_end.settings().most_bytes);
}

hal::Result<void> EmulatedSpiBus::open(const hal::SpiMode&) {
  if (!front_end_.present(clock_.now_ns())) return not_there(description_.name);
  open_ = true;
  return {};
}

hal::Result<void> EmulatedSpiBus::exchange(std::span<const hal::SpiSegment> segments) {
  if (!open_) return not_open(description_.name);
  const std::int64_t now_ns = clock_.now_ns();
  const std::int64_t over_ns = now_ns + front_end_.duration_of(segments);
  const auto outcome =
      settings_ ? front_end_.exchange_settings(segments, now_ns) : front_end_.exchange(segments, now_ns);
  if (outcome == EmulatedFrontEnd::Outcome::gone) return gone(description_.name);
  clock_.sleep_until_ns(over_ns);
  if (outcome == EmulatedFrontEnd::Outcome::failed) {
    return hal::fail(ErrorCode::io, description_.name, "the transfer failed: Input/output error");
  }
  return {};
}

hal::Result<void> EmulatedEdgeLine::open() {
  if (!front_end_.present(clock_.now_ns())) return not_there(name_);
  front_end_.clear_edges();
  open_ = true;
  return {};
}

hal::Result<hal::Edge> EmulatedEdgeLine::wait(std::int64_t deadline_ns) {
  if (!open_) return not_open(name_);
  for (;;) {
    const std::int64_t now_ns = clock_.now_ns();
    if (!front_end_.present(now_ns)) return gone(name_);
    if (const auto edge = front_end_.take_edge(now_ns)) return *edge;
    if (now_ns >= deadline_ns) return hal::timed_out();
    clock_.sleep_until_ns(std::min(front_end_.next_edge_ns(now_ns), deadline_ns));
  }
}

EmulatedOutputLines::EmulatedOutputLines(EmulatedFrontEnd& front_end, hal::Clock& clock, OutputUse use)
    : front_end_(front_end),
      clock_(clock),
      use_(use),
      name_(use == OutputUse::reset ? "emulated reset" : "emulated chip select") {}

hal::Result<void> EmulatedOutputLines::open() {
  if (!front_end_.present(clock_.now_ns())) return not_there(name_);
  open_ = true;
  return set(0);
}

hal::Result<void> EmulatedOutputLines::set(std::uint32_t levels) {
  if (!open_) return not_open(name_);
  if (!front_end_.present(clock_.now_ns())) return gone(name_);
  if (use_ == OutputUse::reset) {
    front_end_.reset_level((levels & 1U) != 0, clock_.now_ns());
  } else {
    front_end_.select(levels);
  }
  return {};
}

}  // namespace compueye::frontend
