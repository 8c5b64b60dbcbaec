// What a host and an eye say to each other over the real libusb, when nothing goes wrong.

#include <doctest/doctest.h>

#include <string>

#include "drivers/transport/usb_libusb.hpp"
#include "tests/hil/level2/benches.hpp"

namespace compueye::hil {
namespace {

TEST_CASE("usb: an eye is listed with its serial, product and bus") {
  HIL_TESTBED(testbed);
  UsbPort left(testbed, eye("LEFT"), 4), right(testbed, eye("RIGHT"), 5);
  CHECK(transport::list_usb_eyes().value().empty());
  left.plug();
  right.plug();
  const auto eyes = transport::list_usb_eyes();
  REQUIRE(eyes);
  REQUIRE(eyes->size() == 2);
  CHECK(eyes->at(0).serial == "LEFT");
  CHECK(eyes->at(0).bus == "usb 1-4");
  CHECK(eyes->at(0).product == "emulated eye");
  CHECK(eyes->at(0).reachable());
  CHECK(eyes->at(1).serial == "RIGHT");
  CHECK(eyes->at(1).bus == "usb 1-5");
  right.unplug();
  CHECK(transport::list_usb_eyes().value().size() == 1);
}

TEST_CASE("usb: an eye is selected by its serial, and errors name those that are there") {
  HIL_TESTBED(testbed);
  transport::UsbTransport none;
  const auto nothing = none.open();
  REQUIRE_FALSE(nothing);
  CHECK(nothing.error().code == hal::ErrorCode::not_found);

  UsbPort left(testbed, eye("LEFT"), 4), right(testbed, eye("RIGHT"), 5);
  left.plug();
  right.plug();
  transport::UsbTransport wanted(with_serial("RIGHT"));
  REQUIRE(wanted.open());
  CHECK(wanted.describe().serial == "RIGHT");
  CHECK(wanted.describe().bus == "usb 1-5");
  CHECK(wanted.describe().max_packet == 512);
  transport::UsbTransport absent(with_serial("MIDDLE"));
  test::check_error(absent.open(), hal::ErrorCode::not_found, "MIDDLE", {"MIDDLE", "LEFT", "1-4", "RIGHT", "1-5"});
}

TEST_CASE("usb: every frame of a stream arrives bit for bit, and nothing after STOP") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1", 300));
  REQUIRE(bench.transport.open());
  const auto told = bench.host.identify();
  REQUIRE(told);
  CHECK(*told == bench.port.cable.with([](auto& device, auto) { return device.descriptor(); }));

  bench.host.frame_rate_mhz = 400'000;
  REQUIRE(bench.host.restart());
  bench.check_frames(0, 400);
  CHECK(bench.host.account().total_dropped() == 0);
  REQUIRE(bench.host.request(protocol::Request::stop));
  CHECK(bench.host.status().value().state == protocol::DeviceState::configured);
  while (bench.host.frame(bench.in_ms(500))) {
  }
  CHECK(bench.host.frame(bench.in_ms(50)).error().code == hal::ErrorCode::timeout);
  const auto truth = bench.port.cable.with([](auto& device, auto) { return device.truth(); });
  CHECK(truth.packets_lost == 0);
  CHECK(bench.transport.counters().errors == 0);
}

TEST_CASE("usb: requests that the eye refuses are io, and the next one is answered") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1"));
  REQUIRE(bench.transport.open());
  const auto start = bench.host.request(protocol::Request::start);  // not configured
  REQUIRE_FALSE(start);
  CHECK(start.error().code == hal::ErrorCode::io);
  const auto status = bench.host.status();
  REQUIRE(status);
  CHECK(status->last_error == protocol::StatusError::wrong_state);
  const std::array<std::byte, 5> five{};
  std::array<std::byte, 8> reply{};
  CHECK(bench.host.request(protocol::Request::ping, five, reply).error().code == hal::ErrorCode::usage);
  CHECK(bench.transport.write(five, bench.in_ms(10)).error().code == hal::ErrorCode::unsupported);
}

TEST_CASE("usb: transfers in flight stay within their bounds, whatever the reader does") {
  HIL_TESTBED(testbed);
  transport::UsbSettings settings;
  settings.transfers = 8;
  settings.transfer_bytes = 5000;  // becomes ten packets of 512
  UsbBench bench(testbed, eye("CE-1", 1000), settings);
  bench.host.frame_rate_mhz = 500'000;
  REQUIRE(bench.host.start());
  for (int k = 0; k < 20; ++k) REQUIRE(bench.host.frame());
  REQUIRE(wait_until([&] { return bench.port.file().waiting() == 0; }));  // nobody reads, so all transfers are full
  bench.port.cable.pass(300'000'000);
  for (int k = 0; k < 100; ++k) REQUIRE(bench.host.frame());
  CHECK(bench.host.account().total_dropped() == 0);  // the eye's own memory held the rest
  const auto counters = bench.port.file().counters();
  CHECK(counters.most_waiting <= 8 + 1);  // and a request
  CHECK(counters.most_waiting_bytes <= 8 * 5120 + 8 + 4096);
  CHECK(bench.transport.counters().most_in_flight == 8);
}

TEST_CASE("usb: reading does not use the heap, with and without data") {
  HIL_TESTBED(testbed);
  UsbBench bench(testbed, eye("CE-1", 300));
  bench.host.frame_rate_mhz = 400'000;
  REQUIRE(bench.host.start());
  bench.check_frames(0, 5);
  check_reading_without_heap(bench);
}

TEST_CASE("usb: settings beyond their limits are refused before the device is touched") {
  HIL_TESTBED(testbed);
  struct Case {
    int transfers;
    std::size_t transfer_bytes, most_in_flight;
  };
  for (const Case& each : {Case{7, 16384, 8U << 20U}, Case{33, 16384, 8U << 20U}, Case{16, 0, 8U << 20U},
                           Case{16, 16384, 16U << 20U}, Case{32, 1U << 20U, 8U << 20U}}) {
    transport::UsbSettings settings;
    settings.transfers = each.transfers;
    settings.transfer_bytes = each.transfer_bytes;
    settings.most_in_flight_bytes = each.most_in_flight;
    transport::UsbTransport transport(settings);
    const auto refused = transport.open();
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == hal::ErrorCode::out_of_range);
  }
}

TEST_CASE("usb: every look finds the eyes that are there now") {
  HIL_TESTBED(testbed);
  UsbPort port(testbed, eye("CE-1"));
  CHECK(transport::list_usb_eyes().value().empty());
  for (int time = 0; time < 2; ++time) {
    port.plug();
    testbed.announce(port.sys_path(), "add");  // twice, as udev may
    CHECK(transport::list_usb_eyes().value().size() == 1);
    port.unplug();
    CHECK(transport::list_usb_eyes().value().empty());
  }
}

}  // namespace
}  // namespace compueye::hil
