#include "firmware/pipeline/stage_beat.hpp"

#include <doctest/doctest.h>

#include <array>
#include <atomic>

#include "tests/firmware/pipeline/rig.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;

TEST_CASE("every stage tells its work, waits when the run is over, and begins anew with the next") {
  Rig rig;
  StageBeats beats;
  rig.settings.beats = &beats;
  for (int round = 0; round < 2; ++round) {
    rig.sink.frames.clear();
    CHECK(rig.run().frames.delivered == 10);
    for (std::size_t i = 0; i < stage_count; ++i) {
      CAPTURE(stage_names[i]);
      const StageProgress progress = beats.progress()[i];
      // The end of the stream is a read as well.
      CHECK(progress.ended == (i == 0 ? 11 : 10));
      CHECK_FALSE(progress.working);
      CHECK(progress.fruitless_from_ns == 0);
    }
  }
}

TEST_CASE("a sink that is at work is seen there, since when, and by how long at the longest") {
  Rig rig;
  StageBeats beats;
  rig.settings.beats = &beats;
  std::array<StageProgress, stage_count> seen{};
  rig.sink.on_write = [&](const compueye::hal::Frame& frame) {
    if (frame.frame == 4) rig.clock.advance(1'000'000'000);
    if (frame.frame == 6) seen = beats.progress();
  };
  REQUIRE(rig.run().frames.delivered == 10);
  const StageProgress& publish = seen[static_cast<std::size_t>(Stage::publish)];
  CHECK(publish.working);
  CHECK(publish.ended == 6);
  CHECK(publish.longest_ns >= 1'000'000'000);
}

TEST_CASE("frames that are thrown away as faulty are told until one is handed on") {
  Rig rig;
  StageBeats beats;
  rig.settings.beats = &beats;
  rig.settings.config_patience = 0;
  rig.clock.advance(1'000'000'000);
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.config_id = index > 5 ? 9U : 1U;
    return frame;
  };
  REQUIRE(rig.run().frames.delivered == 6);
  const StageProgress correct = beats[Stage::correct].progress();
  CHECK(correct.fruitless_from_ns > 0);
  CHECK(correct.fruitless_to_ns >= correct.fruitless_from_ns);
  CHECK(correct.ended == 10);
  CHECK(beats[Stage::reconstruct].progress().fruitless_from_ns == 0);
  beats[Stage::correct].handed_on();
  CHECK(beats[Stage::correct].progress().fruitless_from_ns == 0);
}

TEST_CASE("each thread is told which stage it is before its first frame") {
  Rig rig;
  std::array<std::atomic<int>, stage_count> begun{};
  rig.settings.thread_begins = [&](Stage stage) { ++begun[static_cast<std::size_t>(stage)]; };
  REQUIRE(rig.run().frames.delivered == 10);
  for (const auto& times : begun) CHECK(times == 1);
}

TEST_CASE("whoever holds a queue up inherits the priority of who waits") {
  const InheritingMutex mutex;
  CHECK(mutex.inherits());
}
