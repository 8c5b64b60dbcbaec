// What goes wrong between a host and an eye on HID, over the real hidapi.

#include <doctest/doctest.h>

#include <cerrno>
#include <string>

#include "tests/hil/level2/benches.hpp"

namespace compueye::hil {
namespace {

using protocol::FaultKind;

constexpr std::int64_t quiet_ns = 2'000'000'000;

TEST_CASE("hid: 200 ms without data are a timeout, and the stream goes on") {
  HIL_TESTBED(testbed);
  HidBench bench(testbed, hid_eye("CE-1"));
  REQUIRE(bench.host.start());
  bench.check_frames(0, 10);
  bench.port.cable.inject({.kind = FaultKind::silence, .duration_ns = quiet_ns});
  hal::Result<std::size_t> got = std::size_t{0};
  const std::int64_t begin_ns = bench.clock.now_ns();
  while (got) got = bench.read(200);
  CHECK(got.error().code == hal::ErrorCode::timeout);
  CHECK(bench.clock.now_ns() - begin_ns >= 200'000'000);
  bench.port.cable.pass(quiet_ns);
  CHECK(bench.host.frame());
}

TEST_CASE("hid: cut, damaged, lost and repeated reports cost only themselves") {
  HIL_TESTBED(testbed);
  for (const FaultKind kind : {FaultKind::short_read, FaultKind::bit_error, FaultKind::lose_packets,
                               FaultKind::duplicate_packets, FaultKind::overrun}) {
    const std::string serial(protocol::name(kind));
    CAPTURE(serial);
    HidBench bench(testbed, hid_eye(serial), {.serial = serial});
    REQUIRE(bench.host.start());
    bench.check_frames(0, 10);
    bench.port.cable.inject({.kind = kind, .count = 2});
    const auto& counters = bench.host.reports.counters();
    const auto shown = [&] {
      return bench.host.account().total_dropped() + counters.wrong_length + counters.crc_errors +
                 counters.duplicate_parts + counters.late_parts >
             0;
    };
    for (int k = 0; k < 30 || (k < 1000 && !shown()); ++k) {  // a busy reader first meets what was made before
      const auto block = bench.host.frame();
      REQUIRE(block);
      REQUIRE(bench.host.right(*block, block->frame));
    }
    CHECK(bench.host.account().balanced());
    CHECK(bench.host.account().total_dropped() <= 2);
    CHECK((counters.wrong_length > 0) == (kind == FaultKind::short_read));
    CHECK((counters.crc_errors > 0) == (kind == FaultKind::bit_error));
    CHECK((counters.duplicate_parts + counters.late_parts > 0) == (kind == FaultKind::duplicate_packets));
    bench.port.unplug();
  }
}

TEST_CASE("hid: a failing read is io, and the next one works") {
  HIL_TESTBED(testbed);
  HidBench bench(testbed, hid_eye("CE-1"));
  REQUIRE(bench.host.start());
  bench.check_frames(0, 10);
  bench.port.file().fail_reads(EIO);
  test::check_error(bench.read(500), hal::ErrorCode::io, bench.transport.describe().bus + " (CE-1)",
                    {std::to_string(EIO)});
  const auto block = bench.host.frame();
  REQUIRE(block);
  CHECK(bench.host.right(*block, block->frame));
}

TEST_CASE("hid: the kernel's queue overflows when nobody reads: bounded, and every frame accounted") {
  HIL_TESTBED(testbed);
  HidBench bench(testbed, hid_eye("CE-1"));
  bench.host.frame_rate_mhz = 400'000;
  REQUIRE(bench.host.start());
  bench.check_frames(0, 5);
  bench.port.file().let_overflow();
  REQUIRE(wait_until([&] { return bench.port.file().counters().dropped >= 10; }));  // five frames' reports
  std::uint64_t last = 0;
  for (int k = 0; k < 100; ++k) {
    const auto block = bench.host.frame();
    REQUIRE(block);
    REQUIRE(bench.host.right(*block, block->frame));
    last = block->frame;
  }
  CHECK(bench.port.file().counters().dropped > 0);
  CHECK(bench.port.file().counters().most_queued == EmulatedHidraw::queue_reports);
  CHECK(bench.host.account().drops(hal::DropReason::transport_gap) > 0);
  CHECK(bench.host.account().balanced());
  CHECK(bench.host.account().produced >= last);
}

TEST_CASE("hid: unplugged it is disconnected, plugged in again it streams on, another serial does not") {
  HIL_TESTBED(testbed);
  HidBench bench(testbed, hid_eye("CE-1"), {.serial = "CE-1"});
  check_unplugging(bench, "CE-1", "CE-2");
}

}  // namespace
}  // namespace compueye::hil
