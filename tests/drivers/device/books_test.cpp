// No valid sample under a wrong number, and no frame invented: EyeRig holds every frame to what the eye showed in it.

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/frame_header.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "tests/drivers/device/eye_rig.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;
using hal::DropReason;
using protocol::buses;
using protocol::Request;
using protocol::tests::eye_settings;

namespace {

void read_frames(EyeRig& rig, int frames) {
  for (int f = 0; f < frames; ++f) REQUIRE(rig.next_frame());
}

/// What is missing in the books, or too much; after stop().
std::int64_t unaccounted(EyeRig& rig) {
  rig.source().stop();
  const hal::FrameAccount account = rig.source().account();
  REQUIRE(account.balanced());
  REQUIRE(account.estimated <= account.total_dropped());
  return static_cast<std::int64_t>(account.produced - rig.shown.made());
}

/// Gives every packet of a chunk the number `leap` further, with a right CRC.
void leap_in(std::span<std::byte> chunk, std::uint32_t leap) {
  while (chunk.size() >= protocol::least_packet_bytes) {
    protocol::FrameHeader header = protocol::load_header(chunk.first<protocol::header_bytes>());
    REQUIRE(header.packet_bytes() <= chunk.size());
    header.frame += leap;
    protocol::store(header, chunk.first<protocol::header_bytes>());
    const std::size_t covered = header.packet_bytes() - protocol::packet_crc_bytes;
    protocol::store_little(chunk.data() + covered, protocol::crc32c(chunk.first(covered)));
    chunk = chunk.subspan(header.packet_bytes());
  }
}

}  // namespace

TEST_CASE("nobody reads for longer than numbers can tell: the stream begins anew, and every frame keeps its number") {
  struct Pause {
    const Bus* bus;
    std::int64_t periods;
    std::uint64_t late;  // of late_reader
  };
  constexpr std::int64_t half = std::int64_t{1} << 31U;
  const Pause pauses[] = {{&hid_bus, 1000, 0},     {&hid_bus, 32600, 0},  {&hid_bus, 32780, 1}, {&hid_bus, 40000, 1},
                          {&hid_bus, 65535, 1},    {&hid_bus, 65536, 1},  {&hid_bus, 65600, 1}, {&hid_bus, 99000, 1},
                          {&hid_bus, 131200, 1},   {&usb_bus, 131200, 0}, {&usb_bus, half, 1},  {&usb_bus, 2 * half, 1},
                          {&usb_bus, 3 * half, 1}, {&hid_bus, half, 1}};
  for (const Pause& pause : pauses) {
    CAPTURE(pause.bus->name);
    CAPTURE(pause.periods);
    auto emulator = eye_settings(pause.bus);
    emulator.fifo_bytes = 64 * 64;
    EyeRig rig(emulator);
    REQUIRE(rig.start());
    read_frames(rig, 50);
    rig.clock.advance(pause.periods * 10 * ms);
    read_frames(rig, 200);
    CHECK(rig.source().failures()[Failure::late_reader] == pause.late);
    CHECK(unaccounted(rig) == 0);
    CHECK(rig.source().account().estimated == 0);
  }
}

TEST_CASE("frame numbers and the sequence of packets go round at 2^32 within a stream") {
  auto emulator = eye_settings(&usb_bus);
  emulator.fifo_bytes = 64 * 64;
  EyeRig rig(emulator);
  REQUIRE(rig.start());
  for (int pause = 0; pause < 5; ++pause) {
    read_frames(rig, 50);
    rig.clock.advance(std::int64_t{2'000'000'000} * 10 * ms);
  }
  read_frames(rig, 50);
  CHECK(rig.shown.made() > (std::uint64_t{2} << 32U));
  CHECK(rig.source().failures()[Failure::late_reader] == 0);
  CHECK(rig.source().failures()[Failure::doubtful_time] == 0);
  CHECK(unaccounted(rig) == 0);
}

TEST_CASE("a number that time has no room for is not believed, whatever its CRC says") {
  for (const std::uint32_t leap : {100U, 1'000'000U, 0x7000'0000U}) {
    for (const int packets : {1, 1000}) {
      CAPTURE(leap);
      CAPTURE(packets);
      auto emulator = eye_settings(&usb_bus);
      emulator.events = false;
      EyeRig rig(emulator);
      REQUIRE(rig.start());
      read_frames(rig, 20);
      int left = packets;
      rig.way->at_bytes = [&](std::span<std::byte> chunk) {
        if (left-- > 0) leap_in(chunk, leap);
      };
      // A device that goes on so is begun anew, until the way is mended.
      while (left > 0) static_cast<void>(rig.read());
      read_frames(rig, 50);
      CHECK(rig.source().failures()[Failure::wrong_number] > 0);
      CHECK(unaccounted(rig) == 0);
    }
  }
}

TEST_CASE("an eye that starts anew twice in an outage: no frame is invented, and what was estimated is said to be") {
  for (const Bus* const bus : buses) {
    for (std::int64_t apart = 40 * ms; apart <= 240 * ms; apart += 20 * ms) {
      for (const bool streams : {false, true}) {
        CAPTURE(bus->name);
        CAPTURE(apart);
        CAPTURE(streams);
        auto emulator = eye_settings(bus);
        emulator.boot_ns = 30 * ms;
        EyeRig rig(emulator);
        REQUIRE(rig.start());
        read_frames(rig, 20);
        const std::int64_t now_ns = rig.clock.now_ns() + 3 * ms;
        rig.inject({.kind = FaultKind::reboot, .at_ns = now_ns, .value = streams ? 1 : 0});
        rig.inject({.kind = FaultKind::reboot, .at_ns = now_ns + apart});
        read_frames(rig, 20);
        CHECK(unaccounted(rig) == 0);
        // The frame that was being exposed, at most.
        CHECK(rig.source().account().estimated <= 1);
      }
    }
  }
}

TEST_CASE("an eye that started anew between the last STATUS and SET_CONFIG counts its stream all the same") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    auto emulator = eye_settings(bus);
    emulator.boot_ns = 0;
    EyeRig rig(emulator);
    REQUIRE(rig.start());
    read_frames(rig, 20);
    bool recovers = true;
    int asked = 0;
    rig.way->at_request = [&](Request request, const auto& done) {
      if (!done || request != Request::status) return;
      if (std::exchange(recovers, false)) rig.inject({.kind = FaultKind::reboot});
      ++asked;
    };
    rig.inject({.kind = FaultKind::stall_stream});
    read_frames(rig, 50);
    // It was asked for the time of this stream, and told it.
    CHECK(asked <= 4);
    CHECK(rig.next_frame()->flags.time_ok);
    // Its clock counts from before the stream, as if that had never begun.
    rig.inject({.kind = FaultKind::clock_jump, .value = 3600 * second});
    rig.inject({.kind = FaultKind::stall_stream});
    rig.clock.advance(350 * second);
    read_frames(rig, 20);
    CHECK(unaccounted(rig) == 0);
    CHECK(rig.source().account().estimated == 0);
  }
}

TEST_CASE("what is known by count is no estimate, what is known by time alone is one") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    EyeRig rig(eye_settings(bus));
    REQUIRE(rig.start());
    read_frames(rig, 20);
    rig.inject({.kind = FaultKind::silence});
    read_frames(rig, 20);
    CHECK(rig.source().account().total_dropped() > 0);
    CHECK(rig.source().account().estimated == 0);
    rig.inject({.kind = FaultKind::lose_packets, .count = 4});
    rig.clock.advance(25 * ms);
    rig.inject({.kind = FaultKind::unplug, .duration_ns = 200 * ms});
    read_frames(rig, 20);
    CHECK(rig.source().account().estimated == 2);
    CHECK(unaccounted(rig) == 0);
  }
}

TEST_CASE("a START whose answer is lost began a stream, and its frames are in the books") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    EyeRig rig(eye_settings(bus));
    int lost = 2;
    rig.way->at_request = [&](Request request, const auto& outcome) {
      if (outcome && request == Request::get_config && lost-- > 0) rig.inject({.kind = FaultKind::lose_answers});
    };
    REQUIRE(rig.start());
    read_frames(rig, 20);
    CHECK(rig.source().account().drops(DropReason::transport_gap) > 15);
    CHECK(rig.source().failures()[Failure::request_timeout] == 2);
    lost = 3;
    rig.inject({.kind = FaultKind::stall_stream});
    read_frames(rig, 20);
    CHECK(rig.source().failures()[Failure::request_timeout] == 5);
    CHECK(unaccounted(rig) == 0);
    CHECK(rig.source().account().estimated == 0);
  }
}

TEST_CASE("no stream is begun with a configuration whose tag is that of an eye without one") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    EyeRig rig(eye_settings(bus));
    REQUIRE(rig.start());
    for (int stream = 0; stream < 40; ++stream) {
      CHECK(rig.source().configuration().config_id % 16 != 0);
      read_frames(rig, 2);
      rig.inject({.kind = FaultKind::stall_stream});
    }
    CHECK(rig.source().failures()[Failure::restart] >= 39);
  }
}

TEST_CASE("a clock that is set while frames are lost: no time is trusted that is not right") {
  for (const Bus* const bus : buses) {
    for (const std::int64_t step : {-900 * ms, -200 * ms, -60 * ms, 60 * ms, 7 * second}) {
      for (const std::uint64_t lost : {2U, 10U, 25U}) {
        CAPTURE(bus->name);
        CAPTURE(step);
        CAPTURE(lost);
        auto emulator = eye_settings(bus);
        emulator.events = false;
        EyeRig rig(emulator);
        REQUIRE(rig.start());
        read_frames(rig, 100);
        const auto before = rig.next_frame();
        REQUIRE(before);
        const std::int64_t origin_ns = rig.clock.now_ns() - before->t_ns;
        // Of an eye of 64 channels a frame is a packet, or two reports.
        rig.inject({.kind = FaultKind::lose_packets, .count = lost * (bus == &hid_bus ? 2 : 1)});
        rig.inject({.kind = FaultKind::clock_jump, .at_ns = rig.clock.now_ns() + ms, .value = step});
        int trusted = 0;
        for (int f = 0; f < 20; ++f) {
          const auto block = rig.next_frame();
          REQUIRE(block);
          if (!block->flags.time_ok) continue;
          ++trusted;
          CHECK(std::abs(rig.clock.now_ns() - block->t_ns - (origin_ns - step)) <= 6 * ms);
        }
        CHECK(trusted >= 18);
      }
    }
  }
}

TEST_CASE("a quartz that is four in a hundred fast makes no number unbelievable, however long nobody reads") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    auto emulator = eye_settings(bus);
    emulator.fifo_bytes = 4096;
    EyeRig rig(emulator, source_settings(bus), std::make_unique<hal::VirtualClock>(10 * second), 40'000.0);
    REQUIRE(rig.start());
    read_frames(rig, 20);
    rig.clock.advance(20 * second);
    read_frames(rig, 200);
    CHECK(rig.source().failures()[Failure::wrong_number] == 0);
    CHECK(rig.source().failures()[Failure::restart] == 0);
    CHECK(unaccounted(rig) == 0);
  }
}

TEST_CASE("an eye that went while nobody looked: no frame is invented for the time after it was last seen") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    EyeRig rig(eye_settings(bus));
    rig.estimates_may_err = true;
    REQUIRE(rig.start());
    read_frames(rig, 20);
    rig.inject({.kind = FaultKind::unplug, .at_ns = rig.clock.now_ns() + 30 * ms, .duration_ns = 4 * second});
    rig.clock.advance(3 * second);
    read_frames(rig, 20);
    CHECK(rig.miscounted() <= 0);
    CHECK(unaccounted(rig) >= -4);
    CHECK(unaccounted(rig) <= 0);
  }
}

TEST_CASE("an eye that is given up still tells how many frames it made, though the reader is short of time") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus->name);
    DeviceSettings settings = source_settings(bus);
    settings.recovery_limit_ns = 0;
    EyeRig rig(eye_settings(bus), settings);
    REQUIRE(rig.start());
    read_frames(rig, 20);
    rig.inject({.kind = FaultKind::silence, .duration_ns = 0});
    int unanswered = 0;
    rig.way->at_request = [&](Request request, auto& outcome) {
      if (request != Request::status || rig.source().recovering() || unanswered >= 3) return;
      ++unanswered;
      outcome = tl::unexpected(hal::timed_out().value());
    };
    auto end = rig.next_frame(second, 20 * ms);
    REQUIRE_FALSE(end);
    CHECK(end.error().code == hal::ErrorCode::disconnected);
    CHECK(unanswered == 3);
    CHECK(rig.source().account().estimated == 0);
    CHECK(unaccounted(rig) == 0);
  }
}
