#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "drivers/transport/hid_hidapi.hpp"
#include "drivers/transport/usb_libusb.hpp"
#include "hal/clock.hpp"
#include "tests/drivers/protocol/wire_samples.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"
#include "tests/hil/level2/hid_port.hpp"
#include "tests/hil/level2/testbed.hpp"
#include "tests/memory/allocation_counter.hpp"

namespace compueye::hil {

/// An eye as the emulator shows it, with a link fast enough not to matter.
inline protocol::EmulatorSettings eye(const std::string& serial, int channels = 64,
                                      const protocol::Bus* bus = &protocol::usb_bus) {
  protocol::EmulatorSettings settings;
  settings.bus = bus;
  settings.descriptor = protocol::tests::descriptor_of(channels, 12);
  settings.descriptor.serial = serial;
  settings.fifo_bytes = std::size_t{1} << 20U;
  settings.boot_ns = 1'000'000;
  return settings;
}

inline protocol::EmulatorSettings hid_eye(const std::string& serial, int channels = 64) {
  return eye(serial, channels, &protocol::hid_bus);
}

inline transport::UsbSettings with_serial(std::string serial) {
  transport::UsbSettings settings;
  settings.serial = std::move(serial);
  return settings;
}

inline bool whole(const hal::SampleBlock& block) {
  return std::all_of(block.valid.begin(), block.valid.end(), [](std::uint8_t valid) { return valid != 0; });
}

/// How long to wait for what has to come. A test that waits for it ends when it is there; RESET_PIPES is a hundred
/// ioctls, and umockdev asks another thread about each, which takes longer than the protocol's 100 ms on a busy
/// machine.
inline constexpr std::int64_t patience_ns = 60'000'000'000;

/// A transport that gives every request the time that a busy machine needs for it.
template <class Transport>
class Unhurried final : public hal::ByteTransport {
 public:
  [[nodiscard]] const hal::TransportDescription& describe() const noexcept override { return inner_.describe(); }
  hal::Result<void> open() override { return inner_.open(); }
  void close() noexcept override { inner_.close(); }
  hal::Result<std::size_t> read(std::span<std::byte> into, std::int64_t deadline_ns) override {
    return inner_.read(into, deadline_ns);
  }
  hal::Result<void> write(std::span<const std::byte> from, std::int64_t deadline_ns) override {
    return inner_.write(from, deadline_ns);
  }
  hal::Result<std::size_t> control(std::uint8_t request, std::span<const std::byte> payload, std::span<std::byte> reply,
                                   std::int64_t) override {
    return inner_.control(request, payload, reply, hal::MonotonicClock().now_ns() + patience_ns);
  }

 private:
  Transport inner_;
};

/// Until an eye just plugged in answers.
template <class Port>
void wait_for_boot(Port& port) {
  port.cable.pass(5'000'000);
}

/// Looks until `holds()`; false when it never does.
template <class Condition>
bool wait_until(Condition&& holds) {
  const hal::MonotonicClock clock;
  for (const std::int64_t end_ns = clock.now_ns() + patience_ns; !holds();) {
    if (clock.now_ns() > end_ns) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  return true;
}

/// An eye in its port and the smallest host in front of the real library.
template <class Port, class Transport, class Settings, const protocol::Bus* bus>
struct Bench {
  Bench(Testbed& testbed, const protocol::EmulatorSettings& eye, Settings settings = {})
      : port(testbed, eye), transport(std::move(settings)), host(transport, clock, bus, eye.descriptor) {
    host.request_ns = host.frame_ns = patience_ns;
    port.plug();
    wait_for_boot(port);
  }
  [[nodiscard]] std::int64_t in_ms(std::int64_t duration) const { return clock.now_ns() + duration * test::ms; }
  [[nodiscard]] hal::Result<std::size_t> read(std::int64_t within_ms) {
    return transport.read(chunk, in_ms(within_ms));
  }
  /// The next chunk, waited for patiently.
  [[nodiscard]] hal::Result<std::size_t> read() { return transport.read(chunk, clock.now_ns() + patience_ns); }
  /// Reads `count` frames from `first` on, each whole, right and the next one.
  void check_frames(std::uint64_t first, std::uint64_t count) {
    for (std::uint64_t k = first; k < first + count; ++k) {
      const auto block = host.frame();
      REQUIRE(block);
      REQUIRE(block->frame == k);
      REQUIRE(whole(*block));
      REQUIRE(host.right(*block, k));
    }
  }

  Port port;
  hal::MonotonicClock clock;
  Transport transport;
  protocol::tests::SmallHost host;
  std::array<std::byte, 16384> chunk{};
};
using UsbBench = Bench<UsbPort, transport::UsbTransport, transport::UsbSettings, &protocol::usb_bus>;
using HidBench = Bench<HidPort, transport::HidTransport, transport::HidSettings, &protocol::hid_bus>;

/// Of a bench that streams: a hundred reads with data, then a hundred without.
template <class AnyBench>
void check_reading_without_heap(AnyBench& bench) {
  int full = 0, timeouts = 0;
  auto used = tests::heap_use_of_this_thread();
  for (int k = 0; k < 100; ++k) full += bench.read() ? 1 : 0;
  CHECK((tests::heap_use_of_this_thread() - used).calls() == 0);
  bench.port.cable.inject({.kind = protocol::FaultKind::silence, .duration_ns = 0});
  used = tests::heap_use_of_this_thread();
  while (bench.read(500)) {
  }
  for (int k = 0; k < 100; ++k) {
    const auto got = bench.read(k % 2);
    timeouts += !got && got.error().code == hal::ErrorCode::timeout ? 1 : 0;
  }
  CHECK((tests::heap_use_of_this_thread() - used).calls() == 0);
  CHECK(full == 100);
  CHECK(timeouts == 100);
}

/// The eye `serial`, which the bench asks for, is pulled out of a running stream; `other` comes in its place, then it
/// comes back.
template <class AnyBench>
void check_unplugging(AnyBench& bench, const std::string& serial, const std::string& other) {
  REQUIRE(bench.host.start());
  bench.check_frames(0, 20);
  bench.port.unplug(other);
  hal::Result<std::size_t> got = std::size_t{0};
  for (int k = 0; got && k < 1000; ++k) got = bench.read();
  REQUIRE_FALSE(got);
  CHECK(got.error().code == hal::ErrorCode::disconnected);
  CHECK(bench.read(10).error().code == hal::ErrorCode::disconnected);
  CHECK(bench.host.status().error().code == hal::ErrorCode::disconnected);
  CHECK(bench.transport.open().error().code == hal::ErrorCode::not_found);
  CHECK(bench.read(10).error().code == hal::ErrorCode::usage);

  bench.port.plug();
  wait_for_boot(bench.port);
  test::check_error(bench.transport.open(), hal::ErrorCode::not_found, serial, {serial, other});

  bench.port.unplug(serial);
  bench.port.plug();
  wait_for_boot(bench.port);
  const auto started = bench.host.start();
  INFO((started ? "" : started.error().text()));
  REQUIRE(started);
  const auto block = bench.host.frame();
  REQUIRE(block);
  CHECK(bench.host.right(*block, 0));
}

}  // namespace compueye::hil

/// The testbed of a test case, or its end when umockdev cannot work here.
#define HIL_TESTBED(name)                                                 \
  if (const auto why = compueye::hil::Testbed::missing(); !why.empty()) { \
    MESSAGE("SKIPPED: " << why);                                          \
    return;                                                               \
  }                                                                       \
  compueye::hil::Testbed name
