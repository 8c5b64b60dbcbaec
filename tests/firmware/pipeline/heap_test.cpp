#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "tests/firmware/pipeline/rig.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;
using compueye::tests::heap_use_of_process;
using compueye::tests::heap_use_of_this_thread;
using compueye::tests::HeapUse;

namespace {

class Looker final : public FrameObserver {
 public:
  float sum = 0.0F;
  void published(const PublishedFrame& frame) noexcept override { sum += frame.y.front(); }
};

/// Every kind of frame that a healthy or a troubled eye sends.
ScriptedFrame troubled(std::uint64_t index) {
  ScriptedFrame frame;
  frame.lost_before = index % 17 == 3 ? 2 : 0;
  frame.timeouts_before = index % 19 == 5 ? 1 : 0;
  frame.invalid_channels = index % 23 == 7 ? Rig::channels : 0;
  frame.saturated_channels = index % 11 == 2 ? 1 : 0;
  frame.config_id = index % 29 == 9 ? 2U : 1U;
  return frame;
}

}  // namespace

TEST_CASE("from the first frame to the last no thread of the pipeline uses the heap") {
  for (const Pacing pacing : {Pacing::every_frame, Pacing::newest_wins}) {
    Rig rig;
    rig.settings.pacing = pacing;
    rig.settings.frames = 300;
    rig.settings.deadline_ns = 1;
    rig.settings.correction.measured.codes = {0.0F, 100.0F};
    for (int m = 0; m < Rig::channels; ++m) {
      for (const float code : {1.0F, 120.0F}) rig.settings.correction.measured.straightened.push_back(code);
    }
    rig.source.length = 1'000'000;
    rig.source.script = troubled;
    HeapUse process_before;
    rig.solver.health_of = [&](std::uint64_t call) {
      // A thread that begins uses the heap under the address sanitizer, and one that was made may not have begun at the
      // first read. By now all have. What the correct thread did with the first frame stays unseen; the acquire thread
      // counts for itself.
      if (process_before.calls() == 0) process_before = heap_use_of_process();
      return call % 13 == 4 ? compueye::recon::Health::invalid : compueye::recon::Health::converged;
    };
    HeapUse acquire_before;
    HeapUse acquire_used;
    HeapUse publish_before;
    bool reading = false;
    rig.source.before_read = [&](std::uint64_t index) {
      // Bursts that no queue holds, as newest_wins wants them, and pauses as of an eye: a source that never waits can
      // keep the queue's lock from everybody else until its million frames are over.
      if (pacing == Pacing::newest_wins && index % 8 == 0) std::this_thread::sleep_for(std::chrono::microseconds(20));
      if (!reading) acquire_before = heap_use_of_this_thread();
      reading = true;
      acquire_used = heap_use_of_this_thread() - acquire_before;
    };
    HeapUse process_used;
    HeapUse publish_used;
    rig.sink.on_write = [&](const compueye::hal::Frame&) {
      process_used = heap_use_of_process() - process_before;
      if (rig.sink.frames.size() == 1) publish_before = heap_use_of_this_thread();
      publish_used = heap_use_of_this_thread() - publish_before;
    };
    Looker looker;
    const RunSummary summary = rig.run(&looker);
    CHECK(summary.frames.delivered == 300);
    CHECK(looker.sum > 0.0F);
    CHECK(summary.frames.drops(compueye::hal::DropReason::solver_invalid) > 0);
    CHECK(acquire_used.calls() == 0);
    CHECK(publish_used.calls() == 0);
    CHECK(process_used.allocations == 0);
    CHECK(process_used.frees == 0);
  }
}

TEST_CASE("a solver that uses the heap is caught by the way this test looks") {
  Rig rig;
  HeapUse before;
  HeapUse used;
  rig.source.before_read = [&](std::uint64_t index) {
    if (index == 0) before = heap_use_of_process();
  };
  std::vector<std::vector<float>> kept(10);
  rig.solver.before_solve = [&](std::uint64_t call) { kept[call].resize(100); };
  rig.sink.on_write = [&](const compueye::hal::Frame&) { used = heap_use_of_process() - before; };
  CHECK(rig.run().frames.delivered == 10);
  CHECK(used.allocations >= 10);
}
