#include "drivers/protocol/frame_assembler.hpp"

#include <doctest/doctest.h>

#include <map>

#include "tests/drivers/protocol/sender_and_receiver.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using hal::DropReason;

TEST_CASE("whole frames come out as they were sent") {
  Sender sender(1);
  Receiver receiver;
  for (int f = 0; f < 50; ++f) receiver.push(sender.frame(1 + below(sender.random(), 6)));
  REQUIRE(receiver.blocks.size() == 50);
  for (const Kept& block : receiver.blocks) {
    CHECK(block.missing() == 0);
    CHECK(block.t_ns == static_cast<std::int64_t>(block.frame + 5) * period_ns);
    CHECK(block.flags.time_ok);
    CHECK_FALSE(block.flags.overrun);
    check_samples(sender, block);
  }
  CHECK(receiver.assembler.account().total_dropped() == 0);
  CHECK(receiver.assembler.counters().incomplete_frames == 0);
}

TEST_CASE("lost, repeated and reordered parts: what came is valid, every frame number has one fate") {
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    CAPTURE(seed);
    Sender sender(seed);
    Random& random = sender.random();
    Receiver receiver;
    std::uint64_t overrun = 0, lost_frames = 0;
    std::map<std::uint64_t, std::ptrdiff_t> missing_channels;
    for (int f = 0; f < 30; ++f) {
      if (below(random, 10) == 0) {
        const std::uint64_t frames = 1 + below(random, 4);
        sender.overrun(frames);
        overrun += frames;
      }
      const std::uint64_t frame = sender.next_frame();
      auto packets = sender.frame(1 + below(random, 5));
      // The EOF part keeps its place: on a transport that keeps order nothing overtakes it.
      if (below(random, 3) == 0) std::shuffle(packets.begin(), packets.end() - 1, random);
      std::ptrdiff_t missing = 0;
      std::vector<SentPacket> arriving;
      for (SentPacket& packet : packets) {
        if (below(random, 8) == 0) {
          missing += packet.header.n_ch;
          continue;
        }
        if (below(random, 8) == 0) arriving.push_back(packet);
        arriving.push_back(std::move(packet));
      }
      if (arriving.empty()) {
        ++lost_frames;
      } else {
        missing_channels[frame] = missing;
      }
      receiver.push(arriving);
    }
    receiver.push(sender.frame());  // so that losses at the end are seen
    REQUIRE(receiver.blocks.size() == missing_channels.size() + 1);
    for (const Kept& block : receiver.blocks) {
      REQUIRE(block.missing() == missing_channels[block.frame]);
      check_samples(sender, block);
    }
    REQUIRE(receiver.assembler.account().balanced());
    REQUIRE(receiver.drops(DropReason::device_overrun) == overrun);
    REQUIRE(receiver.drops(DropReason::transport_gap) == lost_frames);
    REQUIRE(receiver.drops(DropReason::corrupt) == 0);
  }
}

TEST_CASE("a gap is put down to what was seen: the device's counter, damaged bytes, missing packets, in this order") {
  struct Case {
    std::uint64_t overrun, lost, damaged_bytes;
    std::uint64_t expect_overrun, expect_corrupt, expect_transport;
  };
  const std::size_t packet_bytes = least_packet_bytes + packed_bytes(SampleFormat::u12, channels);
  const Case cases[] = {{0, 0, 0, 0, 0, 0},
                        {5, 0, 0, 5, 0, 0},
                        {0, 4, 0, 0, 0, 4},
                        {0, 2, 2 * packet_bytes, 0, 2, 0},
                        {0, 3, packet_bytes, 0, 1, 2},
                        {0, 1, 7, 0, 1, 0},
                        {2, 3, packet_bytes + 1, 2, 2, 1},
                        {0, 0, 500, 0, 0, 0}};
  for (const Case& c : cases) {
    CAPTURE(c.overrun);
    CAPTURE(c.lost);
    CAPTURE(c.damaged_bytes);
    Sender sender(2);
    Receiver receiver;
    receiver.push(sender.frame());
    if (c.overrun > 0) sender.overrun(c.overrun);
    for (std::uint64_t k = 0; k < c.lost; ++k) static_cast<void>(sender.frame());
    receiver.push(sender.frame().front(), c.damaged_bytes);
    receiver.push(sender.frame());
    CHECK(receiver.blocks.size() == 3);
    CHECK(receiver.drops(DropReason::device_overrun) == c.expect_overrun);
    CHECK(receiver.drops(DropReason::corrupt) == c.expect_corrupt);
    CHECK(receiver.drops(DropReason::transport_gap) == c.expect_transport);
    CHECK(receiver.blocks[1].flags.overrun == (c.expect_overrun > 0));
    CHECK_FALSE(receiver.blocks[2].flags.overrun);
  }
}

TEST_CASE("a frame that lost a part is out at its EOF, one that lost its EOF at the next frame") {
  Sender sender(14);
  Receiver receiver;
  const auto first = sender.frame(3), second = sender.frame(3), third = sender.frame(1);
  receiver.push(first[0]);
  receiver.push(first[2]);
  REQUIRE(receiver.blocks.size() == 1);
  CHECK(receiver.blocks[0].missing() == first[1].header.n_ch);
  receiver.push(first[1]);
  CHECK(receiver.assembler.counters().late_parts == 1);
  receiver.push(second[0]);
  receiver.push(second[1]);
  CHECK(receiver.blocks.size() == 1);
  receiver.push(third[0]);
  REQUIRE(receiver.blocks.size() == 3);
  CHECK(receiver.blocks[1].missing() == second[2].header.n_ch);
  CHECK(receiver.blocks[2].missing() == 0);
  CHECK(receiver.assembler.account().total_dropped() == 0);
}

TEST_CASE("frames that the device left out without a word are its own overrun, for no packet is missing") {
  Sender sender(3);
  Receiver receiver;
  receiver.push(sender.frame());
  sender.jump_to(9, 1);
  receiver.push(sender.frame());
  CHECK(receiver.drops(DropReason::device_overrun) == 8);
  CHECK(receiver.blocks[1].flags.overrun);
}

TEST_CASE("frame, seq and dropped go round without a jump") {
  Sender sender(4);
  Receiver receiver;
  constexpr std::uint64_t step = 0x7FFFFFF0;  // the furthest ahead that is ahead
  std::uint64_t at = 0;
  std::uint32_t seq = 0;
  for (int turn = 0; turn < 7; ++turn) {
    sender.jump_to(at, seq);
    receiver.push(sender.frame());
    receiver.push(sender.frame());
    CHECK(receiver.blocks.back().frame == at + 1);
    at += step;
    seq += 0x7FFFFF00U;
  }
  CHECK(at > 0x300000000U);
  CHECK(receiver.assembler.account().balanced());
  CHECK(receiver.assembler.counters().late_parts == 0);

  Sender dropping(5);
  Receiver other;
  for (int turn = 0; turn < 5; ++turn) {
    dropping.overrun(40000);
    other.push(dropping.frame());
  }
  CHECK(other.drops(DropReason::device_overrun) == 200000);
}

TEST_CASE("packets of another configuration, late ones and unknown types are counted and used for nothing") {
  Sender sender(6);
  Receiver receiver;
  receiver.push(sender.frame());
  auto stale = sender.frame();
  for (SentPacket& packet : stale) packet.header.config_id = 3;
  receiver.push(stale);
  const auto third = sender.frame(2);
  receiver.push(third);
  receiver.push(third);
  receiver.push(sender.other(static_cast<PacketType>(9), {}));
  receiver.push(sender.other(PacketType::log, std::vector<std::byte>(5)));
  std::vector<std::byte> event(EventPayload::bytes);
  store(EventPayload{EventPayload::illumination_settled, 42}, std::span(event).first<EventPayload::bytes>());
  receiver.push(sender.other(PacketType::event, event));
  receiver.push(sender.other(PacketType::event, {}));
  const AssemblerCounters& c = receiver.assembler.counters();
  CHECK(c.other_config == 1);
  CHECK(c.late_parts == 2);
  CHECK(c.late_in_a_row == 2);
  CHECK(c.unknown_types == 1);
  CHECK(c.logs == 1);
  CHECK(c.events == 2);
  REQUIRE(receiver.assembler.last_event());
  CHECK(receiver.assembler.last_event()->code == EventPayload::illumination_settled);
  CHECK(receiver.assembler.last_event()->argument == 42);
  CHECK(receiver.blocks.size() == 2);
  receiver.push(sender.frame());
  CHECK(receiver.assembler.counters().late_in_a_row == 0);
  // Log and event packets carried their sequence numbers: only the stale packet is missing.
  CHECK(receiver.assembler.missing_packets() == 1);
}

TEST_CASE("events between the parts of a frame do not end it") {
  Sender sender(7);
  Receiver receiver;
  const auto parts = sender.frame(3);
  receiver.push(parts[0]);
  receiver.push(sender.other(PacketType::event, std::vector<std::byte>(8)));
  receiver.push(parts[1]);
  receiver.push(sender.other(PacketType::log, {}));
  receiver.push(parts[2]);
  REQUIRE(receiver.blocks.size() == 1);
  CHECK(receiver.blocks[0].missing() == 0);
}

TEST_CASE("a part that overlaps one that came is not used") {
  Sender sender(8);
  Receiver receiver;
  const auto parts = sender.frame(3);
  receiver.push(parts[0]);
  SentPacket wide = parts[1];
  wide.header.first_ch = static_cast<std::uint16_t>(wide.header.first_ch - 1);
  receiver.push(wide);
  receiver.push(parts[1]);
  receiver.push(parts[2]);
  CHECK(receiver.assembler.counters().duplicate_parts == 1);
  REQUIRE(receiver.blocks.size() == 1);
  CHECK(receiver.blocks[0].missing() == 0);
  check_samples(sender, receiver.blocks[0]);
}

TEST_CASE("a clock that jumps makes one frame's time doubtful") {
  for (const std::int64_t jump_ns :
       {-3'600'000'000'000, -2 * period_ns, -period_ns / 2, period_ns / 2, 900 * period_ns}) {
    CAPTURE(jump_ns);
    Sender sender(9);
    sender.clock_step_ns = 4'000'000'000'000;
    Receiver receiver;
    for (int f = 0; f < 4; ++f) receiver.push(sender.frame());
    sender.clock_step_ns += jump_ns;
    for (int f = 0; f < 4; ++f) receiver.push(sender.frame());
    for (const Kept& block : receiver.blocks) CHECK(block.flags.time_ok == (block.frame != 4));
  }
  Sender honest(10);
  Receiver receiver;
  receiver.push(honest.frame());
  honest.extra_flags = packet_flag::sat | packet_flag::dark;
  receiver.push(honest.frame());
  CHECK_FALSE(receiver.blocks[1].flags.time_ok);
  CHECK(receiver.blocks[1].flags.saturated);
  CHECK(receiver.blocks[1].flags.dark);
  auto late_clock = honest.frame();
  late_clock[0].header.flags |= packet_flag::time_ok;
  late_clock[0].header.t_ns = ~std::uint64_t{0};
  receiver.push(late_clock);
  CHECK_FALSE(receiver.blocks[2].flags.time_ok);
  CHECK(receiver.blocks[2].t_ns > 0);
}

TEST_CASE("flush delivers what is in hand, stop drops it, a lost outage has numbers") {
  Sender sender(11);
  Receiver receiver;
  receiver.push(sender.frame(3)[0]);
  CHECK(receiver.blocks.empty());
  receiver.assembler.flush();
  receiver.take();
  REQUIRE(receiver.blocks.size() == 1);
  CHECK(receiver.blocks[0].missing() > 0);
  CHECK(receiver.assembler.counters().incomplete_frames == 1);

  receiver.push(sender.frame(2)[0]);
  receiver.assembler.lose(10, DropReason::transport_gap);
  CHECK(receiver.drops(DropReason::transport_gap) == 11);
  receiver.assembler.begin_stream(config_id + 1);
  Sender again(12);
  auto packets = again.frame();
  packets[0].header.config_id = config_id + 1;
  receiver.assembler.push({packets[0].header, packets[0].payload, 0});
  const auto block = receiver.assembler.take();
  REQUIRE(block);
  CHECK(block->frame == 12);

  auto partial = again.frame(2);
  partial[0].header.config_id = config_id + 1;
  receiver.assembler.push({partial[0].header, partial[0].payload, 0});
  receiver.assembler.stop();
  CHECK(receiver.drops(DropReason::stopped) == 1);
  CHECK(receiver.assembler.account().balanced());
  CHECK(receiver.assembler.account().produced == 14);
}

TEST_CASE("blocks that nobody takes are superseded, not forgotten") {
  Sender sender(13);
  Receiver receiver;
  for (int f = 0; f < 5; ++f) {
    const auto packets = sender.frame();
    receiver.assembler.push({packets[0].header, packets[0].payload, 0});
  }
  CHECK(receiver.drops(DropReason::superseded) == 4);
  receiver.take();
  CHECK(receiver.blocks.size() == 1);
}
