#include <doctest/doctest.h>

#include "drivers/protocol/cobs.hpp"
#include "tests/drivers/protocol/emulated_eye.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::protocol;
using namespace compueye::protocol::tests;
using compueye::tests::heap_use_of_this_thread;

TEST_CASE("from bytes to frames nothing uses the heap, damaged or not") {
  for (const Bus* const bus : buses) {
    CAPTURE(bus == &hid_bus);
    EmulatorSettings settings = eye_settings(bus, 640);
    settings.fifo_bytes = 8192;
    settings.descriptor.most_payload = 301;
    const FaultKind kinds[] = {FaultKind::bit_error,         FaultKind::short_read, FaultKind::lose_packets,
                               FaultKind::duplicate_packets, FaultKind::overrun,    FaultKind::clock_jump};
    std::uint64_t at_frame = 10;
    for (const FaultKind kind : kinds)
      settings.faults.push_back({.kind = kind, .at_frame = at_frame += 5, .count = 3, .value = 1'000'000'000});
    settings.faults.push_back({.kind = FaultKind::babble, .at_frame = at_frame + 5, .duration_ns = 30'000'000});
    EmulatedEye eye(settings);
    REQUIRE(eye.start());
    int frames = 0, timeouts = 0;
    const auto before = heap_use_of_this_thread();
    for (int f = 0; f < 200; ++f) {
      const auto block = eye.frame(eye.clock.now_ns() + 100'000'000);
      frames += block ? 1 : 0;
      const auto late = eye.frame(eye.clock.now_ns());
      timeouts += !late && late.error().code == hal::ErrorCode::timeout ? 1 : 0;
    }
    const auto used = heap_use_of_this_thread() - before;
    CHECK(used.calls() == 0);
    CHECK(frames > 150);
    CHECK(timeouts > 100);
    std::uint64_t begun = 0;
    for (const std::uint64_t count : eye.device.truth().faults) begun += count;
    CHECK(begun == 7);
  }
}

TEST_CASE("the stages that no emulated eye goes through use the heap as little") {
  Random random(1);
  std::vector<std::byte> wire = random_bytes(random, 20000), into(20000);
  CobsDecoder decoder(300);
  FrameAssembler assembler(64, 12);
  const auto before = heap_use_of_this_thread();
  decoder.feed(wire);
  std::size_t frames = 0;
  while (decoder.next()) ++frames;
  assembler.begin_run();
  assembler.begin_stream(1);
  assembler.flush();
  assembler.lose(3, hal::DropReason::transport_gap);
  assembler.stop();
  const auto used = heap_use_of_this_thread() - before;
  CHECK(used.calls() == 0);
  CHECK(frames + decoder.counters().broken > 20);
}
