// Every fault that the emulator can be made to show, seen by a host without any recovery of its own.

#include <doctest/doctest.h>

#include <set>

#include "tests/drivers/protocol/emulated_eye.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using hal::DropReason;
using hal::ErrorCode;

namespace {

using compueye::test::ms;

/// Runs `check` on both buses with an eye that has streamed a few frames.
template <class Check>
void on_streaming_eyes(Check&& check) {
  for (const Bus* const bus : buses) {
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      CAPTURE(bus == &hid_bus);
      CAPTURE(seed);
      EmulatorSettings settings = eye_settings(bus, 64 + static_cast<int>(seed) * 5, seed);
      settings.events = false;  // a lost packet then is a lost part of a frame
      EmulatedEye eye(settings);
      REQUIRE(eye.start());
      for (std::uint64_t f = 0; f < 3; ++f) {
        const auto block = eye.frame();
        REQUIRE(block);
        REQUIRE(eye.right(*block, f));
      }
      check(eye);
      REQUIRE(eye.account().balanced());
    }
  }
}

void expect_error(const hal::Result<hal::SampleBlock>& result, ErrorCode code) {
  REQUIRE_FALSE(result);
  REQUIRE(result.error().code == code);
}

/// Starts anew, and the frames are right again with numbers that go on.
void expect_recovery(EmulatedEye& eye) {
  const std::uint64_t next = eye.account().produced;
  REQUIRE(eye.start());
  for (std::uint64_t f = 0; f < 5; ++f) {
    const auto block = eye.frame();
    REQUIRE(block);
    REQUIRE(block->frame == next + f);
    REQUIRE(eye.right(*block, f));
  }
}

}  // namespace

TEST_CASE("fault silence: the stream pauses, then goes on with what was not lost") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::silence, .duration_ns = 200 * ms});
    expect_error(eye.frame(eye.clock.now_ns() + 100 * ms), ErrorCode::timeout);
    CHECK(eye.status());
    REQUIRE(eye.frame());
    eye.inject({.kind = FaultKind::silence});
    while (eye.frame(eye.clock.now_ns())) {  // what the host has already
    }
    expect_error(eye.frame(eye.clock.now_ns() + 100 * EmulatedEye::second), ErrorCode::timeout);
    expect_recovery(eye);
  });
}

TEST_CASE("fault control_silence: requests time out, frames go on; for ever means until the bus is reset") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::control_silence, .duration_ns = 300 * ms});
    CHECK(eye.status().error().code == ErrorCode::timeout);
    REQUIRE(eye.frame());
    eye.clock.advance(300 * ms);
    REQUIRE(eye.status());
    eye.inject({.kind = FaultKind::control_silence});
    CHECK(eye.status().error().code == ErrorCode::timeout);
    eye.clock.advance(1000 * EmulatedEye::second);
    CHECK(eye.status().error().code == ErrorCode::timeout);
    expect_recovery(eye);
  });
}

TEST_CASE("fault stall_stream: reads fail until RESET_PIPES") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::stall_stream});
    expect_error(eye.frame(), ErrorCode::io);
    expect_error(eye.frame(), ErrorCode::io);
    CHECK(eye.status());
    REQUIRE(eye.request(Request::reset_pipes));
    CHECK(eye.status().value().state == DeviceState::configured);
    expect_recovery(eye);
  });
}

TEST_CASE("fault stall_control: so many requests are refused, or all until the bus is reset") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::stall_control, .count = 2});
    CHECK(eye.status().error().code == ErrorCode::io);
    CHECK(eye.status().error().code == ErrorCode::io);
    CHECK(eye.status());
    eye.inject({.kind = FaultKind::stall_control, .count = 0});
    for (int k = 0; k < 10; ++k) CHECK(eye.status().error().code == ErrorCode::io);
    expect_recovery(eye);
  });
}

TEST_CASE("faults that damage the way: what is not whole is noticed, the rest is right") {
  const FaultKind kinds[] = {FaultKind::short_read, FaultKind::bit_error, FaultKind::lose_packets,
                             FaultKind::duplicate_packets};
  for (const FaultKind kind : kinds) {
    CAPTURE(name(kind));
    on_streaming_eyes([&](EmulatedEye& eye) {
      const std::uint64_t count = 1 + eye.device.truth().packets % 5;
      eye.inject({.kind = kind, .count = count});
      std::uint64_t missing_channels = 0, frame = 0;
      for (int f = 0; f < 12; ++f) {
        const auto block = eye.frame();
        REQUIRE(block);
        REQUIRE(eye.right(*block, block->frame));
        missing_channels += static_cast<std::uint64_t>(std::count(block->valid.begin(), block->valid.end(), 0));
        frame = block->frame;
      }
      const hal::FrameAccount& account = eye.account();
      REQUIRE(account.produced == frame + 1);
      const bool harmless = kind == FaultKind::duplicate_packets;
      REQUIRE((missing_channels + account.total_dropped() == 0) == harmless);
      REQUIRE(account.drops(DropReason::device_overrun) == 0);
      if (kind == FaultKind::lose_packets) REQUIRE(account.drops(DropReason::corrupt) == 0);
      if (!eye.is_hid() && kind == FaultKind::bit_error) REQUIRE(account.drops(DropReason::corrupt) == count);
      if (!eye.is_hid() && kind == FaultKind::lose_packets) REQUIRE(account.drops(DropReason::transport_gap) == count);
    });
  }
}

TEST_CASE("fault wrong_echo: configuring aborts and names the exposure that came back") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::wrong_echo});
    test::check_error(eye.start(), ErrorCode::mismatch, "eye", {"1001000", "1000000"});
    expect_recovery(eye);
  });
}

TEST_CASE("fault unplug: gone at once, back after a while as after power-on") {
  on_streaming_eyes([](EmulatedEye& eye) {
    const std::uint32_t boots = eye.status().value().boot_count;
    eye.inject({.kind = FaultKind::unplug, .duration_ns = 500 * ms});
    expect_error(eye.frame(), ErrorCode::disconnected);
    CHECK(eye.transport.open().error().code == ErrorCode::not_found);
    eye.clock.advance(600 * ms);
    // The old handle stays dead.
    expect_error(eye.frame(), ErrorCode::disconnected);
    REQUIRE(eye.transport.open());
    CHECK(eye.status().value().boot_count == boots + 1);
    CHECK(eye.status().value().state == DeviceState::idle);
    expect_recovery(eye);
    eye.inject({.kind = FaultKind::unplug});
    expect_error(eye.frame(), ErrorCode::disconnected);
    eye.clock.advance(100000 * EmulatedEye::second);
    CHECK(eye.transport.open().error().code == ErrorCode::not_found);
  });
}

TEST_CASE("fault unplug: a request that waits for its answer ends with it") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::control_silence});
    const std::int64_t gone_ns = eye.clock.now_ns() + 33 * ms;
    eye.device.inject({.kind = FaultKind::unplug, .at_ns = gone_ns});
    CHECK(eye.status().error().code == ErrorCode::disconnected);
    CHECK(eye.clock.now_ns() == gone_ns);
  });
}

TEST_CASE("fault replug_other: another serial is there afterwards") {
  on_streaming_eyes([](EmulatedEye& eye) {
    const std::string before = eye.transport.describe().serial;
    eye.inject({.kind = FaultKind::replug_other, .duration_ns = 10 * ms, .text = "CE-OTHER"});
    expect_error(eye.frame(), ErrorCode::disconnected);
    CHECK(eye.transport.describe().serial == before);
    eye.clock.advance(100 * ms);
    REQUIRE(eye.transport.open());
    CHECK(eye.transport.describe().serial == "CE-OTHER");
    CHECK(eye.identify().value().serial == "CE-OTHER");
  });
}

TEST_CASE("fault clock_jump: forwards and backwards, one frame's time is doubtful") {
  for (const std::int64_t step_ns : {-5000 * ms, 7000 * ms, -100'000'000 * ms}) {
    on_streaming_eyes([&](EmulatedEye& eye) {
      if (eye.is_hid()) eye.reports.set_time(eye.status().value());
      REQUIRE(eye.frame());
      const auto before = eye.status().value().now_ns;
      const auto at_ns = eye.clock.now_ns();
      eye.inject({.kind = FaultKind::clock_jump, .value = step_ns});
      const auto after = eye.status().value();
      const auto passed_ns = static_cast<std::uint64_t>(eye.clock.now_ns() - at_ns);
      if (step_ns > -10000 * ms) {
        CHECK(static_cast<std::int64_t>(after.now_ns - before - passed_ns) == step_ns);
      } else {
        CHECK(after.now_ns == passed_ns);  // a clock has no negative time
      }
      int doubtful = 0;
      for (int f = 0; f < 10; ++f) {
        const auto block = eye.frame();
        REQUIRE(block);
        doubtful += block->flags.time_ok ? 0 : 1;
      }
      CHECK(doubtful >= 1);
      CHECK(doubtful <= 2);
    });
  }
}

TEST_CASE("fault reboot: state lost in mid-frame; one that streams unasked is not believed") {
  for (const std::int64_t unasked : {0, 1}) {
    on_streaming_eyes([&](EmulatedEye& eye) {
      const EmulatorFault reboot{.kind = FaultKind::reboot, .at_frame = 5, .value = unasked};
      eye.inject(reboot);
      std::uint64_t frames = 3;
      auto block = eye.frame();
      for (; block; block = eye.frame()) {
        REQUIRE(block->frame == frames++);
        REQUIRE(eye.right(*block, block->frame));
        REQUIRE(frames <= 6);
      }
      expect_error(block, ErrorCode::timeout);
      const Status status = eye.status().value();
      CHECK(status.config_id == 0);
      CHECK(status.state == (unasked == 1 ? DeviceState::streaming : DeviceState::idle));
      CHECK(status.boot_count == 2);
      const std::uint64_t strange =
          eye.is_hid() ? eye.reports.counters().other_config : eye.packets.counters().other_config;
      CHECK((strange > 0) == (unasked == 1));
      const EmulatorTruth& truth = eye.device.truth();
      CHECK((truth.frames_unasked > 0) == (unasked == 1));
      CHECK(truth.frames - truth.frames_unasked == 5);
      expect_recovery(eye);
    });
  }
}

TEST_CASE("fault babble: garbage without end is never a frame, and ends with a bus reset") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::babble});
    const std::uint64_t before = eye.account().delivered;
    auto block = eye.frame();
    while (block) block = eye.frame();  // what was on its way
    expect_error(block, ErrorCode::timeout);
    CHECK(eye.account().delivered <= before + 2);
    if (eye.is_hid()) {
      CHECK(eye.reports.counters().wrong_id + eye.reports.counters().crc_errors > 500);
    } else {
      CHECK(eye.stream.counters().skipped_bytes > 10'000'000);
      CHECK(eye.stream.counters().bad_headers > 100);
    }
    REQUIRE(eye.request(Request::reset_pipes));
    expect_error(eye.frame(eye.clock.now_ns() + 20 * ms), ErrorCode::timeout);
    expect_recovery(eye);
    eye.inject({.kind = FaultKind::babble, .duration_ns = 50 * ms});
    eye.clock.advance(100 * ms);
    REQUIRE(eye.frame());
  });
}

TEST_CASE("fault other_version: found out when it is identified, and by PING") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::other_version, .value = 0x21});
    test::check_error(eye.identify(), ErrorCode::unsupported, eye.transport.describe().bus, {"2.1", "1.0"});
    std::byte nonce[4] = {};
    std::array<std::byte, PingReply::bytes> pong{};
    REQUIRE(eye.request(Request::ping, nonce, pong));
    CHECK(parse_ping(pong, 0, "eye").value().version == ProtocolVersion{2, 1});
    eye.inject({.kind = FaultKind::other_version, .value = 0x13});
    CHECK(eye.identify());
    expect_recovery(eye);
  });
}

TEST_CASE("fault overrun: frames that the device drops are its own, to the last one") {
  on_streaming_eyes([](EmulatedEye& eye) {
    eye.inject({.kind = FaultKind::overrun, .at_frame = 6, .count = 4});
    bool flagged = false;
    for (int f = 0; f < 10; ++f) {
      const auto block = eye.frame();
      REQUIRE(block);
      REQUIRE(eye.right(*block, block->frame));
      CHECK(block->flags.overrun == (block->frame == 10));
      flagged = flagged || block->flags.overrun;
    }
    CHECK(flagged);
    CHECK(eye.account().drops(DropReason::device_overrun) == 4);
    CHECK(eye.account().total_dropped() == 4);
    CHECK(eye.device.truth().frames_overrun == 4);
    CHECK(eye.status().value().overruns == 4);
  });
}

TEST_CASE("every fault has a name of its own") {
  std::set<std::string_view> names;
  for (std::size_t k = 0; k < fault_kind_count; ++k) names.insert(name(static_cast<FaultKind>(k)));
  CHECK(names.size() == fault_kind_count);
}
