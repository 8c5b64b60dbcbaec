// What recovery promises when faults meet: it ends, in time, and blames the device for what the device did.

#include <algorithm>
#include <vector>

#include "drivers/device/stream_reader.hpp"
#include "drivers/protocol/frame_header.hpp"
#include "tests/drivers/device/eye_rig.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using hal::ErrorCode;
using protocol::buses;
using protocol::Request;
using protocol::tests::eye_settings;

namespace {

void read_on(EyeRig& rig, int frames) {
  for (int f = 0; f < frames; ++f) REQUIRE(rig.next_frame());
}

/// How often open() is called while the eye is away for 2 s, its requests unanswered from `silent_ns` on.
std::uint64_t opens_of_an_outage(const Bus* bus, std::int64_t slice_ns, std::int64_t silent_ns,
                                 std::int64_t unplugged_ns) {
  constexpr std::uint64_t too_many = 1000;
  EyeRig rig(eye_settings(bus));
  REQUIRE(rig.start());
  read_on(rig, 5);
  std::uint64_t opens = 0;
  rig.way->at_open = [&] { REQUIRE(++opens < too_many); };
  const std::int64_t now_ns = rig.clock.now_ns();
  if (bus == &hid_bus) {
    rig.inject({.kind = FaultKind::clock_jump, .at_ns = now_ns + ms, .value = second});
  } else {
    rig.inject({.kind = FaultKind::stall_stream, .at_ns = now_ns + ms});
  }
  rig.inject({.kind = FaultKind::control_silence, .at_ns = now_ns + silent_ns, .duration_ns = 500 * ms});
  rig.inject({.kind = FaultKind::unplug, .at_ns = now_ns + unplugged_ns, .duration_ns = 2 * second});
  while (rig.clock.now_ns() < now_ns + 2 * second) static_cast<void>(rig.read(slice_ns));
  read_on(rig, 3);
  return opens;
}

}  // namespace

TEST_CASE("an unplugging while a request is under way: read() returns, and open() is called as the pauses say") {
  std::uint64_t most = 0;
  for (const Bus* const bus : buses) {
    for (const std::int64_t slice_ns : {20 * ms, 100 * ms}) {
      for (std::int64_t silent_ns = 1 * ms; silent_ns <= 4 * ms; silent_ns += ms / 4) {
        for (std::int64_t unplugged_ns = 20 * ms; unplugged_ns <= 150 * ms; unplugged_ns += 10 * ms) {
          CAPTURE(bus->name);
          CAPTURE(slice_ns);
          CAPTURE(silent_ns);
          CAPTURE(unplugged_ns);
          most = std::max(most, opens_of_an_outage(bus, slice_ns, silent_ns, unplugged_ns));
        }
      }
    }
  }
  CHECK(most <= 12);
}

TEST_CASE("a transport that answers at once with nothing neither stops read() nor its clock") {
  for (const Bus* const bus : buses) {
    EyeRig rig(eye_settings(bus));
    REQUIRE(rig.start());
    read_on(rig, 3);
    int reads = 0;
    rig.way->nothing_at_once = [&] { return ++reads > 0; };
    for (int r = 0; r < 5; ++r) CHECK_FALSE(rig.read(20 * ms));
    CHECK(reads < 200'000);
    rig.way->nothing_at_once = nullptr;
    read_on(rig, 3);
  }
}

TEST_CASE("an eye that starts anew while it is configured is not blamed for a wrong echo") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    auto emulator = eye_settings(bus);
    emulator.boot_ns = 0;  // it answers at once, and shows no configuration
    EyeRig rig(emulator);
    REQUIRE(rig.start());
    read_on(rig, 5);
    int reboots = 4;
    rig.way->at_request = [&](Request request, const auto& done) {
      if (done && request == Request::set_config && reboots-- > 0) rig.inject({.kind = FaultKind::reboot});
    };
    rig.inject({.kind = FaultKind::stall_stream});
    const std::int64_t began_ns = rig.clock.now_ns();
    read_on(rig, 1);
    CHECK(rig.clock.now_ns() - began_ns <= 400 * ms);
    CHECK(rig.source().failures()[Failure::rebooted] == 4);
    CHECK(rig.source().failures()[Failure::wrong_echo] == 0);
  }
}

TEST_CASE("wrong echoes end it when there is no right one between them, and the words tell the time") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    EyeRig rig(eye_settings(bus));
    REQUIRE(rig.start());
    read_on(rig, 5);
    int halts = 3;
    rig.way->at_request = [&](Request request, const auto& done) {
      if (!done || request != Request::start || halts-- <= 0) return;
      rig.inject({.kind = FaultKind::stall_stream, .at_ns = rig.clock.now_ns() + ms});
      rig.inject({.kind = FaultKind::wrong_echo});
    };
    rig.inject({.kind = FaultKind::wrong_echo});
    rig.inject({.kind = FaultKind::stall_stream});
    read_on(rig, 3);
    CHECK(rig.source().failures()[Failure::wrong_echo] == 4);

    rig.inject({.kind = FaultKind::wrong_echo, .count = 3});
    rig.inject({.kind = FaultKind::stall_stream});
    test::check_error(rig.next_frame(), ErrorCode::disconnected, "CE-1", {"0.0"});
  }
}

TEST_CASE("create() ends in its time, however slowly a long description comes") {
  for (const Bus* const bus : buses) {
    auto emulator = eye_settings(bus, bus == &hid_bus ? 200 : 65535);
    emulator.fifo_bytes = std::size_t{1} << 21U;
    hal::VirtualClock clock(10 * second);
    auto device = protocol::DeviceEmulator::create(emulator, protocol::tests::shown(12), clock.now_ns()).value();
    auto transport = std::make_unique<TamperedTransport>(device, clock);
    transport->at_request = [&](Request request, const auto&) {
      if (request == Request::get_desc) clock.advance(95 * ms);
    };
    DeviceSettings settings = source_settings(bus);
    settings.start_limit_ns = second;
    const auto made = DeviceSource::create(settings, std::move(transport), clock);
    CHECK(clock.now_ns() <= 11 * second + 100 * ms);
    test::check_error(made, ErrorCode::timeout, "emulator " + std::string(bus->name), {"1.0"});
  }
}

TEST_CASE("an eye that comes back with a description that is slow to come is given up in time") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    auto emulator = eye_settings(bus, bus == &hid_bus ? 200 : 65535);
    emulator.fifo_bytes = std::size_t{1} << 21U;
    DeviceSettings settings = source_settings(bus);
    settings.start_limit_ns = second;
    settings.recovery_limit_ns = 2 * second;
    EyeRig rig(emulator, settings);
    REQUIRE(rig.start());
    read_on(rig, 3);
    rig.way->at_request = [&](Request request, const auto&) {
      if (request == Request::get_desc) rig.clock.advance(95 * ms);
    };
    rig.inject({.kind = FaultKind::unplug, .duration_ns = 10 * ms});
    const std::int64_t began_ns = rig.clock.now_ns();
    // Past the rig, which wants every deadline kept to the nanosecond; here a page is as late as it is.
    auto end = rig.source().read(rig.clock.now_ns() + second);
    while (!end && end.error().code == ErrorCode::timeout) end = rig.source().read(rig.clock.now_ns() + second);
    test::check_error(end, ErrorCode::disconnected, "CE-1", {"1.0"});
    CHECK(rig.clock.now_ns() - began_ns <= 4 * second);
  }
}

TEST_CASE("an eye that starts anew says anew what it is, though nobody opens it again") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    auto emulator = eye_settings(bus);
    emulator.boot_ns = 0;
    int opened = 0, described = 0;  // the rig's last words are counted, too
    EyeRig rig(emulator);
    REQUIRE(rig.start());
    read_on(rig, 3);
    rig.way->at_open = [&] { ++opened; };
    rig.way->at_request = [&](Request request, const auto&) { described += request == Request::get_desc ? 1 : 0; };
    rig.inject({.kind = FaultKind::reboot});
    read_on(rig, 3);
    CHECK(opened == 0);
    CHECK(described > 0);
  }
}

TEST_CASE("a reader looks at hostile bytes in pieces of bounded work") {
  std::vector<std::byte> chunk(std::size_t{1} << 16U);
  protocol::FrameHeader hostile;
  hostile.n_ch = 32760;
  hostile.payload_bytes = 65520;
  for (std::size_t at = 0; at + protocol::header_bytes <= chunk.size(); at += protocol::header_bytes) {
    protocol::store(hostile, std::span(chunk).subspan(at).first<protocol::header_bytes>());
  }
  const auto reader = make_stream_reader(usb_bus.framing, eye_settings(&usb_bus, 65535).descriptor);
  reader->begin_run();
  reader->begin_stream(1, 10 * ms);
  reader->push(chunk, 100);
  CHECK_FALSE(reader->take());
  reader->push(chunk, 100);  // completes what each of the first wants
  const auto wrong = [&] {
    FailureCounters failures;
    reader->add_failures(failures);
    return failures[Failure::crc_error];
  };
  std::uint64_t most = 0;
  do {
    const std::uint64_t before = wrong();
    CHECK_FALSE(reader->take());
    most = std::max(most, wrong() - before);
  } while (reader->has_more());
  CHECK(most > 0);
  CHECK(most <= 20);  // of 64 KiB each
}
