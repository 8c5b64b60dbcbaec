// Signals between a host and an eye over the real libgpiod, 1.6 or 2 (COMPUEYE_LIBGPIOD).

#include <doctest/doctest.h>

#include <linux/gpio.h>
#include <pthread.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "drivers/transport/gpio_gpiod.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hil/level2/benches.hpp"
#include "tests/hil/level2/gpio_port.hpp"

namespace compueye::hil {
namespace {

using hal::ErrorCode;
using transport::GpioBias;
using transport::GpioEdgeLine;
using transport::GpioOutputLines;

constexpr bool counts = COMPUEYE_LIBGPIOD == 2;
constexpr std::int64_t first_ns = 7'000'000'000'123;

/// A chip with eight lines, of which line 3 is called DRDY, line 5 belongs to a lamp and line 6 has no interrupt.
struct GpioBench {
  explicit GpioBench(Testbed& testbed)
      : port(testbed,
             {{}, {.name = "RESET"}, {}, {.name = "DRDY"}, {}, {.consumer = "lamp"}, {.interrupts = false}, {}}),
        chip(port.chip),
        ready({.chip = port.name(), .line = "DRDY"}) {}
  [[nodiscard]] std::int64_t now_ns() const { return clock.now_ns(); }
  /// What the line gives without waiting.
  [[nodiscard]] hal::Result<hal::Edge> next() { return ready.wait(0); }
  /// `count` pulses a microsecond apart, number `first` of all at its time.
  void pulse(int first, int count) {
    for (int k = first; k < first + count; ++k) {
      chip.edge(3, true, first_ns + k * 1000);
      chip.edge(3, false, first_ns + k * 1000 + 500);
    }
  }
  /// Reads pulses `first` on.
  void check_edges(int first, int count) {
    for (int k = first; k < first + count; ++k) {
      const auto edge = next();
      REQUIRE(edge);
      CHECK(edge->t_ns == first_ns + k * 1000);
      CHECK(edge->number.has_value() == counts);
      if (counts) CHECK(edge->number == static_cast<std::uint64_t>(k + 1));
    }
  }
  hal::MonotonicClock clock;
  GpioPort port;
  EmulatedGpiochip& chip;
  GpioEdgeLine ready;
};

TEST_CASE("gpio: a line is asked for by number or name, with its edge and bias, in our name") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  CHECK(bench.ready.name() == bench.port.name() + " line DRDY");
  REQUIRE(bench.ready.open());
  CHECK(bench.chip.last_interface() == COMPUEYE_LIBGPIOD);
  CHECK(bench.chip.last_consumer() == "compueye");
  CHECK(bench.chip.lines[3].rising);
  CHECK_FALSE(bench.chip.lines[3].falling);
  CHECK(bench.chip.lines[3].bias == 0);
  const std::array<std::uint64_t, 3> flags{GPIO_V2_LINE_FLAG_BIAS_DISABLED, GPIO_V2_LINE_FLAG_BIAS_PULL_UP,
                                           GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN};
  const std::array<GpioBias, 3> biases{GpioBias::off, GpioBias::pull_up, GpioBias::pull_down};
  for (std::size_t k = 0; k < biases.size(); ++k) {
    GpioEdgeLine line({bench.port.path(), "7", true, biases[k]});
    CHECK(line.name() == bench.port.name() + " line 7");
    REQUIRE(line.open());
    REQUIRE(line.open());  // again: the first request has ended
    CHECK(bench.chip.lines[7].falling);
    CHECK_FALSE(bench.chip.lines[7].rising);
    CHECK(bench.chip.lines[7].bias == flags[k]);
  }
}

TEST_CASE("gpio: edges come in order with the kernel's times, those that waited first, until none is left") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  CHECK(bench.next().error().code == ErrorCode::usage);
  REQUIRE(bench.ready.open());
  bench.pulse(0, 5);
  bench.check_edges(0, 2);
  bench.pulse(5, 4);
  bench.check_edges(2, 7);
  CHECK(bench.next().error().code == ErrorCode::timeout);
  const std::int64_t deadline_ns = bench.now_ns() + 2 * test::ms;
  CHECK(bench.ready.wait(deadline_ns).error().code == ErrorCode::timeout);
  CHECK(bench.now_ns() >= deadline_ns);
  CHECK(bench.ready.wait(std::numeric_limits<std::int64_t>::min()).error().code == ErrorCode::timeout);
  bench.pulse(9, 1);
  const auto edge = bench.ready.wait(std::numeric_limits<std::int64_t>::max());
  REQUIRE(edge);
  CHECK(edge->t_ns == first_ns + 9000);

  REQUIRE(bench.ready.open());  // what came before is gone, and counting begins anew
  bench.pulse(0, 1);
  bench.check_edges(0, 1);
}

TEST_CASE("gpio: a wait that signals interrupt goes on until the edge comes") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  REQUIRE(bench.ready.open());
  static std::atomic<int> handled{0};
  handled = 0;
  struct sigaction count {};
  struct sigaction before {};
  count.sa_handler = [](int) { ++handled; };
  REQUIRE(sigaction(SIGUSR1, &count, &before) == 0);
  const pthread_t waiting = pthread_self();
  std::thread other([&] {
    for (int sent = 0; sent < 5; ++sent) {
      pthread_kill(waiting, SIGUSR1);
      while (handled <= sent) std::this_thread::yield();
    }
    bench.pulse(0, 1);
  });
  const auto edge = bench.ready.wait(bench.now_ns() + patience_ns);
  other.join();
  REQUIRE(edge);
  CHECK(edge->t_ns == first_ns);
  CHECK(handled == 5);
  sigaction(SIGUSR1, &before, nullptr);
}

TEST_CASE("gpio: edges that the kernel had no room for are seen in the numbers, where it counts") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  REQUIRE(bench.ready.open());
  bench.pulse(0, 1);
  bench.check_edges(0, 1);
  bench.pulse(1, 40);
  // The second interface loses the oldest, the first the newest.
  bench.check_edges(counts ? 25 : 1, 16);
  CHECK(bench.next().error().code == ErrorCode::timeout);
  if (!counts) return;
  bench.chip.count_from(0xFFFF'FFFF);  // it counts in 32 bits
  bench.pulse(0, 2);
  CHECK(bench.next()->number == 0xFFFF'FFFFU);
  CHECK(bench.next()->number == std::uint64_t{1} << 32U);
}

TEST_CASE("gpio: outputs are set together, are low at first, and low is high where they are active low") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  GpioOutputLines lines({bench.port.name(), {"4", "RESET", "2"}, false});
  CHECK(lines.name() == bench.port.name() + " lines 4, RESET and 2");
  CHECK(lines.count() == 3);
  CHECK(lines.set(1).error().code == ErrorCode::usage);
  bench.chip.lines[4].level = true;
  REQUIRE(lines.open());
  REQUIRE(lines.set(0b101));
  REQUIRE(lines.set(0b010));
  REQUIRE(lines.set(0xFFFF'FFF0));  // bits that no line has
  CHECK(bench.chip.settings() == std::vector<std::uint32_t>{0, 0b101, 0b010, 0});
  REQUIRE(lines.set(0b011));
  CHECK(bench.chip.lines[4].level);
  CHECK(bench.chip.lines[1].level);
  CHECK_FALSE(bench.chip.lines[2].level);
  lines.close();
  CHECK(lines.set(1).error().code == ErrorCode::usage);

  GpioOutputLines inverted({bench.port.name(), {"4", "1"}, true});
  REQUIRE(inverted.open());
  REQUIRE(inverted.set(0b01));
  CHECK(bench.chip.settings().at(5) == 0b11);
  CHECK(bench.chip.settings().at(6) == 0b10);
}

TEST_CASE("gpio: 32 outputs are one call, 33 and none are refused") {
  HIL_TESTBED(testbed);
  GpioPort port(testbed, std::vector<EmulatedGpiochip::Line>(33));
  std::vector<std::string> names;
  for (int k = 0; k < 32; ++k) names.push_back(std::to_string(k));
  GpioOutputLines lines({port.name(), names, false});
  REQUIRE(lines.open());
  REQUIRE(lines.set(0xDEAD'BEEF));
  CHECK(port.chip.settings().at(1) == 0xDEAD'BEEF);
  names.emplace_back("32");
  GpioOutputLines many({port.name(), names, false}), none({port.name(), {}, false});
  CHECK(many.open().error().code == ErrorCode::out_of_range);
  CHECK(none.open().error().code == ErrorCode::out_of_range);
}

TEST_CASE("gpio: what cannot be had is an error that says what to do") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  const std::string& chip = bench.port.name();
  GpioEdgeLine no_chip({"gpiochip99", "0"});
  test::check_error(no_chip.open(), ErrorCode::not_found, "gpiochip99 line 0", {"/dev/gpiochip99", chip});
  for (const char* const name : {"8", "BUSY"}) {
    GpioEdgeLine no_line({chip, name});
    test::check_error(no_line.open(), ErrorCode::not_found, chip + " line " + name, {bench.port.path()});
  }
  GpioOutputLines unnamed({chip, {"1", ""}, false}), twice({chip, {"1", "RESET"}, false});
  CHECK(unnamed.open().error().code == ErrorCode::not_found);
  CHECK(GpioEdgeLine({chip, ""}).open().error().code == ErrorCode::not_found);
  test::check_error(twice.open(), ErrorCode::io, chip + " lines 1 and RESET", {});
  GpioEdgeLine taken({chip, "5"});
  test::check_error(taken.open(), ErrorCode::io, chip + " line 5", {"5", "lamp"});
  GpioOutputLines some_taken({chip, {"1", "5"}, false});
  test::check_error(some_taken.open(), ErrorCode::io, chip + " lines 1 and 5", {"5", "lamp"});
  REQUIRE(bench.ready.open());
  GpioEdgeLine mine({chip, "3"});
  CHECK(mine.open().error().code == ErrorCode::io);
  GpioEdgeLine mute({chip, "6"});
  CHECK(mute.open().error().code == ErrorCode::unsupported);
  bench.chip.fail(EACCES);
  test::check_error(bench.ready.open(), ErrorCode::io, chip + " line DRDY", {bench.port.path(), "gpio"});
  bench.chip.fail(0);
  REQUIRE(bench.ready.open());
}

TEST_CASE("gpio: a chip that goes away ends waiting and setting") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  GpioOutputLines lamp({bench.port.name(), {"4"}, false});
  REQUIRE(bench.ready.open());
  REQUIRE(lamp.open());
  bench.chip.fail(EIO);
  CHECK(lamp.set(1).error().code == ErrorCode::io);
  bench.chip.fail(0);
  REQUIRE(lamp.set(1));
  bench.pulse(0, 2);
  bench.check_edges(0, 1);
  bench.chip.unplug();
  bench.check_edges(1, 1);  // it was read before
  test::check_error(bench.ready.wait(bench.now_ns() + patience_ns), ErrorCode::disconnected, bench.ready.name(), {});
  CHECK(lamp.set(0).error().code == ErrorCode::disconnected);
  CHECK_FALSE(bench.ready.open());
}

TEST_CASE("gpio: waiting and setting do not use the heap") {
  HIL_TESTBED(testbed);
  GpioBench bench(testbed);
  GpioOutputLines lamp({bench.port.name(), {"4", "2"}, false});
  REQUIRE(bench.ready.open());
  REQUIRE(lamp.open());
  bench.pulse(0, 12);
  int edges = 0, timeouts = 0, set = 0;
  const auto used = tests::heap_use_of_this_thread();
  for (std::uint32_t k = 0; k < 20; ++k) {
    const auto edge = bench.next();
    edges += edge ? 1 : 0;
    timeouts += !edge && edge.error().code == ErrorCode::timeout ? 1 : 0;
    set += lamp.set(k) ? 1 : 0;
  }
  CHECK((tests::heap_use_of_this_thread() - used).calls() == 0);
  CHECK(edges == 12);
  CHECK(timeouts == 8);
  CHECK(set == 20);
}

}  // namespace
}  // namespace compueye::hil
