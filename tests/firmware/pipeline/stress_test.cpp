#include <doctest/doctest.h>

#include <random>
#include <thread>

#include "tests/firmware/pipeline/rig.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;
using compueye::hal::DropReason;
using compueye::recon::Health;

namespace {

/// A number that depends on seed and place only, so that a run's troubles do not depend on its timing.
std::uint64_t dice(std::uint64_t seed, std::uint64_t place, std::uint64_t kind) {
  std::uint64_t z = seed * 0x9E3779B97F4A7C15ULL + place * 0xBF58476D1CE4E5B9ULL + kind * 0x94D049BB133111EBULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

void maybe_dawdle(std::uint64_t roll) {
  if (roll % 50 == 0) std::this_thread::yield();
  if (roll % 400 == 1) std::this_thread::sleep_for(std::chrono::microseconds(roll % 300));
}

ScriptedFrame random_frame(std::uint64_t seed, std::uint64_t index) {
  const auto one_in = [&](std::uint64_t n, std::uint64_t kind) { return dice(seed, index, kind) % n == 0; };
  ScriptedFrame frame;
  if (one_in(20, 1)) {
    frame.lost_before = dice(seed, index, 2) % 5;
    frame.lost_as = one_in(2, 3) ? DropReason::device_overrun : DropReason::transport_gap;
  }
  if (one_in(30, 4)) frame.timeouts_before = 1;
  if (one_in(10, 5)) frame.invalid_channels = static_cast<int>(dice(seed, index, 6) % 5);
  if (one_in(10, 7)) frame.saturated_channels = static_cast<int>(dice(seed, index, 8) % 3);
  if (one_in(40, 9)) frame.config_id = 2;
  if (index > 0 && one_in(50, 10)) frame.short_by = 1;
  return frame;
}

void arrange(Rig& rig, std::uint64_t seed) {
  rig.settings.pacing = seed % 2 == 0 ? Pacing::every_frame : Pacing::newest_wins;
  rig.settings.queue_capacity = static_cast<int>(1 + dice(seed, 0, 20) % 5);
  rig.settings.correction.max_missing_share = 0.1;
  rig.settings.correction.expected_config_id = 1;
  rig.settings.stop_on_sink_failure = seed % 5 != 0;
  rig.settings.frames = seed % 3 == 0 ? 700 : 0;
  rig.source.length = 1500;
  rig.source.ending = static_cast<ScriptEnd>(seed % 4);
  rig.source.script = [seed](std::uint64_t index) { return random_frame(seed, index); };
  rig.source.before_read = [seed](std::uint64_t index) { maybe_dawdle(dice(seed, index, 21)); };
  rig.solver.before_solve = [seed](std::uint64_t call) { maybe_dawdle(dice(seed, call, 22)); };
  rig.solver.health_of = [seed](std::uint64_t call) {
    return dice(seed, call, 23) % 15 == 0 ? Health::invalid : Health::budget_used;
  };
  if (seed % 7 == 3) rig.sink.refuses = {dice(seed, 0, 24) % 500, 600};
  if (seed % 7 == 5) {
    const std::uint64_t stop_at = dice(seed, 0, 25) % 800;
    const auto check = rig.sink.on_write;
    rig.sink.on_write = [&rig, check, stop_at](const compueye::hal::Frame& frame) {
      check(frame);
      maybe_dawdle(frame.frame);
      if (frame.frame >= stop_at) rig.stop = true;
    };
  }
}

}  // namespace

TEST_CASE("random troubles in every stage never unbalance the books") {
  for (std::uint64_t seed = 1; seed <= 28; ++seed) {
    CAPTURE(seed);
    Rig rig;
    arrange(rig, seed);
    const RunSummary summary = rig.run();
    CHECK(summary.ending != Ending::internal_failure);
    if (rig.settings.pacing == Pacing::every_frame) CHECK(summary.frames.drops(DropReason::superseded) == 0);
    if (summary.ending == Ending::end_of_stream) {
      CHECK(summary.frames.drops(DropReason::stopped) == 0);
      CHECK(summary.stages.source.delivered == 1500);
    }
    if (summary.ending == Ending::frames_delivered) CHECK(summary.frames.delivered == rig.settings.frames);
    const std::uint64_t by_stage = summary.stages.source.total_dropped() + summary.stages.acquire.total_dropped() +
                                   summary.stages.correct.total_dropped() + summary.stages.reconstruct.total_dropped() +
                                   summary.stages.publish.total_dropped();
    CHECK(by_stage == summary.frames.total_dropped());
  }
}

TEST_CASE("a stop from another thread at any moment leaves balanced books") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Rig rig;
    rig.settings.pacing = seed % 2 == 0 ? Pacing::every_frame : Pacing::newest_wins;
    rig.source.length = 100'000'000;
    rig.sink.on_write = [&](const compueye::hal::Frame& frame) {
      if (!Rig::belongs(frame)) ++rig.wrong_pictures;
      // The sink remembers at most what it has reserved.
      if (rig.sink.frames.size() > 50'000) rig.stop = true;
    };
    std::thread stopper([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(dice(seed, 0, 1) % 3000));
      rig.stop = true;
    });
    const RunSummary summary = rig.run();
    stopper.join();
    CHECK(summary.ending == Ending::stop_requested);
    CHECK_FALSE(summary.failed());
  }
}
