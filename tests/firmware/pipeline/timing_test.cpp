#include <doctest/doctest.h>

#include "tests/firmware/pipeline/rig.hpp"
#include "tests/hal/units.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;

namespace {

/// Lets the source give a frame only when the one before it was published, so that virtual time is exact.
void in_lockstep(Rig& rig, Progress& published) {
  rig.source.before_read = [&](std::uint64_t index) { published.wait_for(index); };
}

class Watcher final : public FrameObserver {
 public:
  explicit Watcher(Progress& published) : published_(published) {}
  std::vector<std::int64_t> ages;
  std::vector<bool> late;
  std::vector<float> first_sample;
  std::vector<std::uint64_t> numbers;
  std::size_t weights = 0;
  std::uint64_t delivered = 0;
  int iterations = 0;

  void published(const PublishedFrame& frame) noexcept override {
    ages.push_back(frame.age_ns);
    late.push_back(frame.late);
    first_sample.push_back(frame.y.front());
    numbers.push_back(frame.frame.frame);
    weights = frame.weights.size();
    delivered = frame.delivered;
    iterations = frame.info.iterations;
    published_.reach(frame.delivered);
  }

 private:
  Progress& published_;
};

using compueye::test::ms;

}  // namespace

TEST_CASE("age runs from the start of exposure to the end of the write, and late frames are counted and published") {
  Rig rig;
  Progress published;
  Watcher watcher(published);
  in_lockstep(rig, published);
  rig.source.period_ns = 10 * ms;
  rig.settings.deadline_ns = 14 * ms;
  rig.solver.takes_ns = [](std::uint64_t call) { return call == 2 || call == 6 ? 5 * ms : 3 * ms; };
  rig.sink.on_write = [&](const compueye::hal::Frame&) { rig.clock.advance(ms); };
  const RunSummary summary = rig.run(&watcher);

  std::vector<std::int64_t> expected(10, 14 * ms);
  expected[2] = expected[6] = 16 * ms;
  CHECK(watcher.ages == expected);
  CHECK(summary.deadline_misses == 2);
  CHECK(watcher.late == std::vector<bool>{false, false, true, false, false, false, true, false, false, false});
  CHECK(summary.frames.delivered == 10);
  CHECK(summary.age.min_ns == 14 * ms);
  CHECK(summary.age.max_ns == 16 * ms);
  CHECK(summary.solve.min_ns == 3 * ms);
  CHECK(summary.solve.max_ns == 5 * ms);
  CHECK(static_cast<double>(summary.solve.median_ns) == doctest::Approx(3e6).epsilon(0.016));
  CHECK(summary.write.min_ns == ms);
  CHECK(summary.write.max_ns == ms);
  // The next read begins 4 or 6 ms into a period that is already running.
  CHECK(summary.wall_ns == 10 * 10 * ms + 4 * ms);
}

TEST_CASE("no deadline, no misses") {
  Rig rig;
  Progress published;
  Watcher watcher(published);
  in_lockstep(rig, published);
  rig.source.period_ns = 10 * ms;
  rig.solver.takes_ns = [](std::uint64_t) { return 1000 * ms; };
  CHECK(rig.run(&watcher).deadline_misses == 0);
}

TEST_CASE("the observer sees the samples, by ommatidium, beside the picture made from them") {
  Rig rig;
  Progress published;
  Watcher watcher(published);
  const RunSummary summary = rig.run(&watcher);
  CHECK(watcher.delivered == summary.frames.delivered);
  CHECK(watcher.numbers == rig.sink.frames);
  CHECK(watcher.weights == Rig::channels);
  CHECK(watcher.iterations == summary.last->iterations);
  REQUIRE(watcher.first_sample.size() == 10);
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    // Ommatidium 0 is the last channel.
    CHECK(watcher.first_sample[frame] == static_cast<float>(ScriptedSource::code(frame, Rig::channels - 1)));
  }
}

TEST_CASE("without a trusted time stamp the age begins one period before arrival") {
  Rig rig;
  Progress published;
  Watcher watcher(published);
  in_lockstep(rig, published);
  rig.source.period_ns = 10 * ms;
  rig.source.description.frame_rate_hz = 100.0;
  rig.source.script = [](std::uint64_t) {
    ScriptedFrame frame;
    frame.flags.time_ok = false;
    return frame;
  };
  rig.solver.takes_ns = [](std::uint64_t) { return 3 * ms; };
  const RunSummary summary = rig.run(&watcher);
  CHECK(summary.age.min_ns == 13 * ms);
  CHECK(summary.age.max_ns == 13 * ms);
}
