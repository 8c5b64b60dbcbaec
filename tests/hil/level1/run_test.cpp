// An eye that fails under a pipeline, in virtual time: the driver's limit is the run's.

#include "firmware/pipeline/pipeline.hpp"
#include "tests/drivers/device/eye_rig.hpp"
#include "tests/firmware/pipeline/fakes.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::device;
using namespace compueye::device::tests;

namespace {

/// 300 frames of an eye that is away for `away_ns` after the first 50.
firmware::RunSummary run_with_outage(const Bus* bus, std::int64_t away_ns, EyeRig& rig) {
  rig.inject({.kind = FaultKind::unplug, .at_frame = 50, .duration_ns = away_ns});
  firmware::tests::CopyingSolver solver(rig.clock, rig.source().describe().channels);
  firmware::tests::RecordingSink sink;
  firmware::PipelineSettings settings;
  settings.pacing = firmware::Pacing::every_frame;
  settings.device_clock = firmware::DeviceClock::free_running;
  settings.frames = 300;
  rig.shown.begin_run();
  const std::atomic<bool> stop{false};
  auto pipeline = firmware::Pipeline::create(settings, rig.source(), solver, sink, rig.clock);
  REQUIRE(pipeline);
  CAPTURE(bus->name);
  CAPTURE(away_ns);
  firmware::RunSummary summary = pipeline->run(stop);
  CHECK(summary.frames.balanced());
  CHECK(summary.frames.produced == rig.shown.made());
  CHECK(summary.frames.delivered == sink.frames.size());
  CHECK(rig.source().faults() == hal::faults_in(summary.source_counters));
  CHECK(rig.source().faults() >= 2);  // unplugged, and looked for in vain
  return summary;
}

}  // namespace

TEST_CASE("a run waits for an eye as long as the driver tries, 30 s, and tells both how long and why not") {
  for (const Bus* const bus : protocol::buses) {
    for (const std::int64_t away_ns : {second, 5500 * ms, 20 * second, 29 * second}) {
      EyeRig rig(protocol::tests::eye_settings(bus));
      const firmware::RunSummary summary = run_with_outage(bus, away_ns, rig);
      CHECK(summary.ending == firmware::Ending::frames_delivered);
      CHECK(summary.frames.delivered == 300);
      CHECK(summary.recovering_ns >= away_ns - 100 * ms);
      CHECK(summary.recovering_ns <= away_ns + 2 * second);
    }
    EyeRig rig(protocol::tests::eye_settings(bus));
    const firmware::RunSummary summary = run_with_outage(bus, 40 * second, rig);
    CHECK(summary.ending == firmware::Ending::source_failed);
    REQUIRE(summary.error);
    test::check_error(*summary.error, hal::ErrorCode::disconnected, "CE-1", {});
    CHECK(summary.recovering_ns >= 29 * second);
    CHECK(summary.recovering_ns <= 31 * second);
    CHECK_FALSE(rig.source().recovering());
  }
}
