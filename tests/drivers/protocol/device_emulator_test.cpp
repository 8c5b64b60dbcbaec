#include "drivers/protocol/device_emulator.hpp"

#include <doctest/doctest.h>

#include "tests/drivers/protocol/emulated_eye.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using hal::DropReason;
using hal::ErrorCode;

TEST_CASE("the emulator describes itself page by page on both buses") {
  for (const Bus* const bus : buses) {
    EmulatedEye eye(eye_settings(bus, 150, 4));
    REQUIRE(eye.transport.open());
    const auto descriptor = eye.identify();
    REQUIRE(descriptor);
    CHECK(*descriptor == eye.device.descriptor());
    CHECK(eye.transport.describe().serial == "CE-4");
    const auto source = descriptor->source_description("usb", 100.0);
    CHECK(source.serial == "CE-4");
    CHECK(source.channels == 150);
    CHECK(source.ommatidium_of_channel == descriptor->ommatidium_of_channel);
  }
}

TEST_CASE("requests: what each state allows, and why the others are refused") {
  for (const Bus* const bus : buses) {
    EmulatedEye eye(eye_settings(bus));
    REQUIRE(eye.transport.open());
    std::array<std::byte, Configuration::bytes> configuration{}, bad{};
    store(eye.wanted(), configuration);
    Configuration beyond = eye.wanted();
    beyond.frame_rate_mhz = 1;
    store(beyond, bad);
    const auto refused = [&](Request request, std::span<const std::byte> payload, StatusError why) {
      const std::uint32_t before = eye.status().value().refused_requests;
      const auto result = eye.request(request, payload);
      REQUIRE_FALSE(result);
      CHECK(result.error().code == ErrorCode::io);
      CHECK(eye.status().value().last_error == why);
      CHECK(eye.status().value().refused_requests == before + 1);
    };
    CHECK(eye.status().value().state == DeviceState::idle);
    CHECK(eye.status().value().config_id == 0);
    refused(Request::start, {}, StatusError::wrong_state);
    refused(Request::set_config, bad, StatusError::out_of_limits);
    REQUIRE(eye.request(Request::stop));
    REQUIRE(eye.request(Request::set_config, configuration));
    CHECK(eye.status().value().state == DeviceState::configured);
    CHECK(eye.status().value().config_id == 1);
    REQUIRE(eye.request(Request::start));
    CHECK(eye.status().value().state == DeviceState::streaming);
    refused(Request::start, {}, StatusError::wrong_state);
    refused(Request::set_config, configuration, StatusError::wrong_state);
    REQUIRE(eye.request(Request::stop));
    REQUIRE(eye.request(Request::stop));
    CHECK(eye.status().value().state == DeviceState::configured);
    std::byte nonce[4] = {std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}};
    std::array<std::byte, PingReply::bytes> pong{};
    REQUIRE(eye.request(Request::ping, nonce, pong));
    CHECK(parse_ping(pong, 0x04030201, "eye"));
  }
}

TEST_CASE("requests that no host of ours sends are refused without harm") {
  DeviceEmulator device = DeviceEmulator::create(eye_settings(&usb_bus), shown(12)).value();
  Random random(1);
  std::uint64_t stalled = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const auto payload = random_bytes(random, below(random, 24));
    std::vector<std::byte> reply(below(random, 64));
    const auto transfer = device.control(trial, static_cast<std::uint8_t>(random() % 14), payload, reply);
    REQUIRE(transfer.bytes <= reply.size());
    stalled += transfer.outcome == DeviceEmulator::Outcome::stalled ? 1 : 0;
  }
  CHECK(stalled > 4000);
  DeviceEmulator hid = DeviceEmulator::create(eye_settings(&hid_bus), shown(12)).value();
  for (int trial = 0; trial < 5000; ++trial) {
    auto report = random_bytes(random, below(random, 5) == 0 ? below(random, 70) : hid_report_bytes);
    if (!report.empty()) report[0] = static_cast<std::byte>(random() % 7);
    static_cast<void>(hid.set_feature(trial, report));
    std::vector<std::byte> into(below(random, 80));
    const auto transfer = hid.get_feature(trial, static_cast<std::uint8_t>(random() % 7), into);
    REQUIRE(transfer.bytes <= into.size());
  }
}

TEST_CASE("frames come in time and in order, with the samples that were shown") {
  for (const Bus* const bus : buses) {
    for (const int channels : {1, 37, 64, 300}) {
      CAPTURE(channels);
      EmulatorSettings settings = eye_settings(bus, channels);
      if (bus == &usb_bus) settings.descriptor.most_payload = 100;  // several packets a frame
      EmulatedEye eye(settings);
      REQUIRE(eye.start());
      const std::int64_t started_ns = eye.clock.now_ns(), period_ns = eye.wanted().period_ns();
      std::int64_t last_t_ns = -1;
      for (std::uint64_t f = 0; f < 50; ++f) {
        const auto block = eye.frame();
        REQUIRE(block);
        REQUIRE(block->frame == f);
        REQUIRE(eye.right(*block, f));
        REQUIRE(std::count(block->valid.begin(), block->valid.end(), 1) == channels);
        REQUIRE(block->t_ns > last_t_ns);
        last_t_ns = block->t_ns;
        const std::int64_t earliest_ns = started_ns + static_cast<std::int64_t>(f + 1) * period_ns;
        REQUIRE(eye.clock.now_ns() >= earliest_ns);
        REQUIRE(eye.clock.now_ns() < earliest_ns + period_ns);
      }
      CHECK(eye.account().total_dropped() == 0);
      CHECK(eye.device.truth().frames_overrun == 0);
    }
  }
}

TEST_CASE("a host that does not read loses frames, and is told exactly how many") {
  for (const Bus* const bus : buses) {
    EmulatorSettings settings = eye_settings(bus);
    settings.fifo_bytes = 3000;
    EmulatedEye eye(settings);
    REQUIRE(eye.start());
    std::uint64_t delivered = 0;
    for (int f = 0; f < 40; ++f) {
      if (f % 7 == 3) eye.clock.advance(400'000'000);  // 40 frames
      const auto block = eye.frame();
      REQUIRE(block);
      ++delivered;
      CHECK(eye.account().balanced());
    }
    // What is on its way is neither dropped nor delivered yet.
    const hal::FrameAccount& account = eye.account();
    CHECK(account.delivered == delivered);
    CHECK(account.drops(DropReason::device_overrun) <= eye.device.truth().frames_overrun);
    CHECK(account.total_dropped() == account.drops(DropReason::device_overrun));
    while (eye.account().produced < eye.device.truth().frames) REQUIRE(eye.frame());
    CHECK(account.drops(DropReason::device_overrun) == eye.device.truth().frames_overrun);
    CHECK(eye.device.truth().frames_overrun > 100);
    CHECK(account.produced == eye.device.truth().frames);
  }
}

TEST_CASE("illumination settles before frames carry its tag; dark means every lamp off") {
  EmulatedEye eye(eye_settings(&usb_bus));
  REQUIRE(eye.start());
  auto block = eye.frame();
  REQUIRE(block);
  CHECK(block->flags.dark);
  const auto set = [&](Illumination light) {
    std::array<std::byte, Illumination::bytes> bytes{};
    store(light, bytes);
    return eye.request(Request::set_illum, bytes);
  };
  REQUIRE(set({7, 5, 200, 45'000'000}));  // the descriptor says 30 ms
  const std::int64_t settled_ns = eye.clock.now_ns() + 45'000'000;
  int changing = 0, lit = 0;
  while (lit < 5) {
    block = eye.frame();
    REQUIRE(block);
    const std::uint8_t illum = eye.packets.conditions().illum;
    const std::int64_t exposure_ns = eye.clock.now_ns() - eye.wanted().period_ns();
    if (illum == illumination_changing) {
      ++changing;
    } else if (illum == 5) {
      ++lit;
      CHECK(exposure_ns >= settled_ns);
      CHECK_FALSE(block->flags.dark);
    }
  }
  CHECK(changing >= 4);
  CHECK(changing <= 6);
  CHECK(eye.packets.counters().events == 1);
  CHECK(eye.packets.last_event()->argument == 5);
  CHECK(eye.packets.counters().logs == 1);
  CHECK_FALSE(set({9, 1, 1, 0}));
  CHECK_FALSE(set({7, 1, 256, 0}));
  CHECK_FALSE(set({7, 0xFF, 1, 0}));
  CHECK(eye.status().value().last_error == StatusError::out_of_limits);
}

TEST_CASE("settings that cannot work are refused") {
  EmulatorSettings small = eye_settings(&usb_bus);
  small.fifo_bytes = 100;
  CHECK(DeviceEmulator::create(small, shown(12)).error().code == ErrorCode::out_of_range);
  EmulatorSettings deep = eye_settings(&hid_bus);
  deep.descriptor = descriptor_of(64, 14);
  CHECK(DeviceEmulator::create(deep, shown(12)).error().code == ErrorCode::out_of_range);
  CHECK(DeviceEmulator::create(eye_settings(&usb_bus), {}).error().code == ErrorCode::usage);
  EmulatorSettings nameless = eye_settings(&usb_bus);
  nameless.descriptor.serial.clear();
  CHECK(DeviceEmulator::create(nameless, shown(12)).error().code == ErrorCode::out_of_range);
}

TEST_CASE("the emulated transport fails as a real one does") {
  EmulatedEye eye(eye_settings(&usb_bus));
  std::array<std::byte, 64> bytes{};
  CHECK(eye.transport.read(bytes, 0).error().code == ErrorCode::usage);
  CHECK(eye.request(Request::stop).error().code == ErrorCode::usage);
  REQUIRE(eye.transport.open());
  CHECK(eye.transport.write(bytes, 0).error().code == ErrorCode::unsupported);
  // Nothing streams: a read takes exactly until its deadline, one that has passed takes no time.
  const std::int64_t now_ns = eye.clock.now_ns();
  const auto late = eye.transport.read(bytes, now_ns + 5'000'000);
  CHECK(late.error().code == ErrorCode::timeout);
  CHECK(late.error().sentence.empty());
  CHECK(eye.clock.now_ns() == now_ns + 5'000'000);
  CHECK(eye.transport.read(bytes, now_ns).error().code == ErrorCode::timeout);
  CHECK(eye.clock.now_ns() == now_ns + 5'000'000);
  CHECK(eye.transport.control(number(Request::stop), {}, {}, eye.clock.now_ns() + 1).error().code ==
        ErrorCode::timeout);

  eye.inject({.kind = FaultKind::unplug});
  CHECK(eye.transport.read(bytes, eye.clock.now_ns()).error().code == ErrorCode::disconnected);
  CHECK_FALSE(eye.transport.read(bytes, eye.clock.now_ns()).error().sentence.empty());
  CHECK(eye.request(Request::stop).error().code == ErrorCode::disconnected);
  CHECK(eye.transport.open().error().code == ErrorCode::not_found);
  eye.transport.close();
  CHECK(eye.transport.read(bytes, 0).error().code == ErrorCode::usage);
}

TEST_CASE("flags stand on the packets that the page names: overrun and an untrusted time on all of their frame") {
  auto settings = eye_settings(&usb_bus);
  settings.descriptor.most_payload = 48;  // two packets a frame
  EmulatedEye eye(settings);
  eye.inject({.kind = FaultKind::overrun, .at_frame = 2, .count = 3});
  eye.inject({.kind = FaultKind::clock_jump, .at_frame = 8, .value = 1000});
  REQUIRE(eye.start());
  PacketStream stream(eye.device.descriptor().packet_limits());
  std::vector<std::byte> chunk(1U << 20U);
  int overruns = 0, untrusted = 0, events = 0;
  const auto look = [&](const Packet& packet) {
    const FrameHeader& h = packet.header;
    CAPTURE(h.frame);
    CHECK(h.has(packet_flag::time_ok) == (h.frame != 8));
    untrusted += h.has(packet_flag::time_ok) ? 0 : 1;
    if (h.type == PacketType::data) {
      CHECK(h.has(packet_flag::overrun) == (h.frame == 5));
      overruns += h.has(packet_flag::overrun) ? 1 : 0;
      return;
    }
    ++events;
    CHECK((h.flags & ~packet_flag::time_ok) == 0);
    CHECK(h.first_ch == 0);
    CHECK(h.n_ch == 0);
    CHECK(h.config_id == 1);
    if (h.frame == 5) CHECK(h.dropped == 3);
  };
  for (int n = 0; n < 12; ++n) {
    eye.clock.advance(10'000'000);
    const auto got = eye.device.read(eye.clock.now_ns(), chunk);
    stream.feed(std::span(chunk).first(got.bytes));
    while (const auto packet = stream.next()) look(*packet);
  }
  CHECK(overruns >= 2);
  CHECK(untrusted == overruns + 1);  // with the event of a clock that was set
  CHECK(events == 3);                // the greeting, overrun began, clock set
}

TEST_CASE("what was counted stands in STATUS after STOP, and a page past the end is refused") {
  for (const Bus* bus : buses) {
    CAPTURE(bus->name);
    EmulatedEye eye(eye_settings(bus));
    REQUIRE(eye.start());
    eye.clock.advance(105'000'000);
    const Status before = eye.status().value();
    REQUIRE(before.frames > 5);
    REQUIRE(eye.request(Request::stop));
    eye.inject({.kind = FaultKind::clock_jump, .value = -5'000'000'000});
    const Status after = eye.status().value();
    CHECK(after.state == DeviceState::configured);
    CHECK(after.config_id == before.config_id);
    CHECK(after.frames == before.frames);
    CHECK(after.packets == before.packets);
    CHECK(after.last_t_ns == before.last_t_ns);
    CHECK(after.fifo_permille == 0);

    std::vector<std::byte> page(60), payload(PageRequest::bytes);
    const std::size_t pages = (serialise(eye.device.descriptor()).value().size() + 59) / 60;
    store(PageRequest{static_cast<std::uint16_t>(pages - 1), 60}, std::span(payload).first<PageRequest::bytes>());
    CHECK(eye.request(Request::get_desc, payload, page));
    store(PageRequest{static_cast<std::uint16_t>(pages), 60}, std::span(payload).first<PageRequest::bytes>());
    CHECK_FALSE(eye.request(Request::get_desc, payload, page));
    CHECK(eye.status().value().last_error == StatusError::out_of_limits);
  }
}
