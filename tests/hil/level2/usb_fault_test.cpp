// What goes wrong between a host and an eye on USB, over the real libusb.

#include <doctest/doctest.h>

#include <cerrno>
#include <string>

#include "drivers/transport/usb_libusb.hpp"
#include "tests/hil/level2/benches.hpp"

namespace compueye::hil {
namespace {

using protocol::FaultKind;

constexpr std::int64_t frozen_ns = 2'000'000'000;

/// Frames come until one lies after everything that went wrong; all of them are right where they are valid. A busy
/// reader first meets what was made before it: with `loses` until a frame is lost.
void check_recovers(UsbBench& bench, bool loses = false) {
  for (int k = 0; k < 50 || (k < 1000 && loses && bench.host.account().total_dropped() == 0); ++k) {
    const auto block = bench.host.frame();
    REQUIRE(block);
    REQUIRE(bench.host.right(*block, block->frame));
  }
  CHECK(bench.host.account().balanced());
}

TEST_CASE("usb: 200 ms without data are a timeout, and the stream goes on without a gap") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1"));
  REQUIRE(bench.host.start());
  bench.check_frames(0, 10);
  bench.port.cable.inject({.kind = FaultKind::silence, .duration_ns = frozen_ns});
  const std::int64_t begin_ns = bench.clock.now_ns();
  hal::Result<std::size_t> got = std::size_t{0};
  while (got) got = bench.read(200);  // what was under way still comes
  CHECK(got.error().code == hal::ErrorCode::timeout);
  CHECK((got.error().place + got.error().sentence).empty());  // without words: no allocation
  CHECK(bench.clock.now_ns() - begin_ns >= 200'000'000);
  bench.port.cable.pass(frozen_ns);
  bench.check_frames(10, 50);
  CHECK(bench.host.account().total_dropped() == 0);
}

TEST_CASE("usb: a stall is io until RESET_PIPES clears both ends") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1"));
  REQUIRE(bench.host.start());
  bench.check_frames(0, 10);
  bench.port.cable.inject({.kind = FaultKind::stall_stream});
  hal::Result<std::size_t> got = std::size_t{0};
  while (got) got = bench.read();
  test::check_error(got, hal::ErrorCode::io, bench.transport.describe().bus + " (CE-1)", {});
  CHECK(bench.read().error().code == hal::ErrorCode::io);
  CHECK(bench.transport.counters().stalls >= 1);
  CHECK(bench.host.status());  // requests are answered

  const auto halts_before = bench.port.file().counters().cleared_halts;
  REQUIRE(bench.host.restart());
  CHECK(bench.port.file().counters().cleared_halts == halts_before + 1);
  const auto block = bench.host.frame();
  REQUIRE(block);
  CHECK(bench.host.right(*block, 0));
}

TEST_CASE("usb: a line error is io once, and what comes after it is right") {
  HIL_TESTBED(testbed);
  for (const int status : {-EPROTO, -EILSEQ, -EOVERFLOW}) {
    CAPTURE(status);
    UsbBench bench(testbed, eye("CE-" + std::to_string(-status)), with_serial("CE-" + std::to_string(-status)));
    REQUIRE(bench.host.start());
    bench.check_frames(0, 10);
    bench.port.file().fail_next(status);
    hal::Result<hal::SampleBlock> block = bench.host.frame();
    for (int k = 0; block && k < 100; ++k) block = bench.host.frame();
    REQUIRE_FALSE(block);
    CHECK(block.error().code == hal::ErrorCode::io);
    check_recovers(bench);
    CHECK(bench.transport.counters().errors == 1);
    bench.port.unplug();
  }
}

TEST_CASE("usb: cut, damaged, lost and repeated packets cost only themselves") {
  HIL_TESTBED(testbed);
  const FaultKind kinds[]{FaultKind::short_read, FaultKind::bit_error, FaultKind::lose_packets,
                          FaultKind::duplicate_packets, FaultKind::overrun};
  for (const FaultKind kind : kinds) {
    CAPTURE(std::string(protocol::name(kind)));
    const std::string serial(protocol::name(kind));
    UsbBench bench(testbed, eye(serial), with_serial(serial));
    REQUIRE(bench.host.start());
    bench.check_frames(0, 10);
    bench.port.cable.inject({.kind = kind, .count = 3});
    check_recovers(bench, kind != FaultKind::duplicate_packets);
    const std::uint64_t lost = bench.host.account().total_dropped();
    CHECK(lost <= 3);
    CHECK((lost > 0) == (kind != FaultKind::duplicate_packets));
    bench.port.unplug();
  }
}

TEST_CASE("usb: a babbling device is survived, and resetting it silences it") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1"));
  REQUIRE(bench.host.start());
  bench.check_frames(0, 10);
  bench.port.cable.inject({.kind = FaultKind::babble, .duration_ns = 0});
  for (int k = 0; k < 200; ++k) {
    const auto got = bench.read();
    REQUIRE(got);
    bench.host.stream.feed(std::span<const std::byte>(bench.chunk).first(*got));
    while (const auto packet = bench.host.stream.next()) bench.host.packets.push(*packet);
  }
  CHECK(bench.host.stream.counters().skipped_bytes > 10'000);
  REQUIRE(bench.host.start());  // opens again, which resets the bus
  const auto block = bench.host.frame();
  REQUIRE(block);
  CHECK(bench.host.right(*block, 0));
}

TEST_CASE("usb: requests that are not answered time out, and opening again is a reset that cures it") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1"));
  REQUIRE(bench.host.start());
  bench.port.cable.inject({.kind = FaultKind::control_silence, .duration_ns = 0});
  bench.host.request_ns = protocol::control_deadline_ns;
  const std::int64_t begin_ns = bench.clock.now_ns();
  const auto status = bench.host.status();
  REQUIRE_FALSE(status);
  CHECK(status.error().code == hal::ErrorCode::timeout);
  const std::int64_t took_ns = bench.clock.now_ns() - begin_ns;
  CHECK(took_ns >= 90'000'000);
  bench.host.request_ns = patience_ns;
  bench.check_frames(0, 5);  // the stream does not mind
  const auto resets = bench.port.file().counters().resets;
  REQUIRE(bench.host.start());
  CHECK(bench.port.file().counters().resets == resets + 1);
  CHECK(bench.host.status());
}

TEST_CASE("usb: unplugged in mid-transfer is disconnected, plugged in again it streams on, another serial does not") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1"), with_serial("CE-1"));
  check_unplugging(bench, "CE-1", "CE-2");
}

TEST_CASE("usb: an eye that another program has, and a kernel without memory, say what to do") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1"));
  bench.port.file().hold_interface(true);
  const auto resets = bench.port.file().counters().resets;
  const std::string place = "usb 1-4 (CE-1)";
  test::check_error(bench.transport.open(), hal::ErrorCode::io, place, {});
  CHECK(bench.port.file().counters().resets == resets);  // the other program's stream goes on
  bench.port.file().hold_interface(false);

  bench.port.file().refuse_submissions(ENOMEM);
  test::check_error(bench.transport.open(), hal::ErrorCode::no_space, place,
                    {"/sys/module/usbcore/parameters/usbfs_memory_mb"});
  CHECK(bench.port.file().waiting() == 0);
  bench.port.file().refuse_submissions(0);
  CHECK(bench.transport.open());
}

TEST_CASE("usb: closing gives back every transfer, whatever is under way") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1", 300));
  bench.host.frame_rate_mhz = 300'000;
  for (int k = 0; k < 20; ++k) {
    REQUIRE(bench.host.start());
    for (int f = 0; f < k % 4; ++f) REQUIRE(bench.host.frame());
    bench.transport.close();
    CHECK(bench.port.file().waiting() == 0);
  }
  const auto counters = bench.port.file().counters();
  CHECK(counters.submitted == counters.reaped);
}

}  // namespace
}  // namespace compueye::hil
