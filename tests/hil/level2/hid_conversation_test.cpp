// What a host and an eye say to each other over the real hidapi.

#include <doctest/doctest.h>

#include <array>
#include <string>

#include "drivers/transport/hid_hidapi.hpp"
#include "tests/hil/level2/benches.hpp"

namespace compueye::hil {
namespace {

using protocol::FaultKind;

TEST_CASE("hid: an eye is listed and selected by its serial") {
  HIL_TESTBED(testbed);
  CHECK(transport::list_hid_eyes().value().empty());
  HidPort left(testbed, hid_eye("LEFT"), 6), right(testbed, hid_eye("RIGHT"), 7);
  left.plug();
  right.plug();
  const auto eyes = transport::list_hid_eyes();
  REQUIRE(eyes);
  REQUIRE(eyes->size() == 2);
  CHECK(eyes->at(0).serial == "LEFT");
  CHECK(eyes->at(0).bus == left.name());
  CHECK(eyes->at(0).product == "emulated eye");
  CHECK(eyes->at(0).reachable());
  CHECK(eyes->at(1).serial == "RIGHT");

  transport::HidTransport wanted({.serial = "RIGHT"});
  REQUIRE(wanted.open());
  CHECK(wanted.describe().serial == "RIGHT");
  CHECK(wanted.describe().bus == right.name());
  CHECK(wanted.describe().max_packet == 64);
  transport::HidTransport absent({.serial = "MIDDLE"});
  test::check_error(absent.open(), hal::ErrorCode::not_found, "MIDDLE",
                    {"MIDDLE", "LEFT", left.name(), "RIGHT", right.name()});
}

TEST_CASE("hid: every frame of a stream arrives bit for bit, and nothing after STOP") {
  HIL_TESTBED(testbed);
  HidBench bench(testbed, hid_eye("CE-1", 64));
  REQUIRE(bench.transport.open());
  const auto told = bench.host.identify();
  REQUIRE(told);
  CHECK(*told == bench.port.cable.with([](auto& device, auto) { return device.descriptor(); }));
  bench.host.frame_rate_mhz = 250'000;
  REQUIRE(bench.host.restart());
  bench.check_frames(0, 300);
  CHECK(bench.host.account().total_dropped() == 0);
  REQUIRE(bench.host.request(protocol::Request::stop));
  while (bench.host.frame(bench.in_ms(500))) {
  }
  CHECK(bench.host.frame(bench.in_ms(50)).error().code == hal::ErrorCode::timeout);
}

TEST_CASE("hid: requests are answered, refused and outlast a silent device") {
  HIL_TESTBED(testbed);
  HidBench bench(testbed, hid_eye("CE-1"));
  std::array<std::byte, 16> small{};
  CHECK(bench.transport.read(bench.chunk, bench.in_ms(1)).error().code == hal::ErrorCode::usage);
  REQUIRE(bench.transport.open());
  CHECK(bench.transport.read(small, bench.in_ms(1)).error().code == hal::ErrorCode::usage);
  const auto start = bench.host.request(protocol::Request::start);  // not configured
  REQUIRE_FALSE(start);
  CHECK(start.error().code == hal::ErrorCode::io);
  CHECK(bench.host.status().value().last_error == protocol::StatusError::wrong_state);
  CHECK(bench.transport.write(small, bench.in_ms(10)).error().code == hal::ErrorCode::unsupported);

  bench.port.cable.inject({.kind = FaultKind::control_silence, .duration_ns = 10'000'000'000});
  bench.host.request_ns = protocol::control_deadline_ns;
  const auto silent = bench.host.status();
  REQUIRE_FALSE(silent);
  CHECK(silent.error().code == hal::ErrorCode::timeout);
  bench.host.request_ns = patience_ns;
  bench.port.cable.pass(10'000'000'000);
  CHECK(bench.host.status());
}

TEST_CASE("hid: reading does not use the heap, with and without data") {
  HIL_TESTBED(testbed);
  HidBench bench(testbed, hid_eye("CE-1"));
  REQUIRE(bench.host.start());
  bench.check_frames(0, 5);
  check_reading_without_heap(bench);
}

}  // namespace
}  // namespace compueye::hil
