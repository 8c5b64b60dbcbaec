// A run whose driver hangs: what the pipeline's reader does meanwhile, and how the run ends.

#include <doctest/doctest.h>

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "drivers/device/hang_proof_source.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "tests/drivers/device/hang_gate.hpp"
#include "tests/drivers/device/hanging_source.hpp"
#include "tests/firmware/pipeline/fakes.hpp"
#include "tests/hal/units.hpp"

namespace compueye::device::tests {
namespace {

using firmware::Ending;
using firmware::Stage;
using hal::tests::ReferenceSource;
using test::second;

/// A run of a source that hangs in its call number `nth`, and comes back at `until_ns` of the clock.
struct HangingRun {
  HangingRun(std::int64_t until_ns, std::size_t ahead) {
    SharedTime time = time_of(clock, gate);
    time.wait = [inner = time.wait, gate = gate, clock = clock, until_ns](auto& lock, auto& told, std::int64_t by_ns) {
      inner(lock, told, by_ns);
      if (clock->now_ns() >= until_ns) gate->release();
    };
    source = HangProofSource::create(
                 "the eye",
                 [gate = gate](hal::Clock& by) -> hal::Result<HangProofSource::Source> {
                   return std::make_unique<HangingSource>(by, gate);
                 },
                 time, ahead)
                 .value();
    settings.pacing = firmware::Pacing::every_frame;
    settings.beats = &beats;
  }

  [[nodiscard]] firmware::RunSummary run(std::uint64_t frames) {
    settings.frames = frames;
    auto pipeline = firmware::Pipeline::create(settings, *source, solver, sink, *clock);
    REQUIRE(pipeline);
    return pipeline->run(stop);
  }
  [[nodiscard]] std::int64_t longest_read_ns() const {
    return beats.progress()[static_cast<std::size_t>(Stage::acquire)].longest_ns;
  }

  std::shared_ptr<hal::VirtualClock> clock = std::make_shared<hal::VirtualClock>(second);
  std::shared_ptr<HangGate> gate = std::make_shared<HangGate>();
  std::unique_ptr<HangProofSource> source;
  firmware::tests::CopyingSolver solver{*clock, ReferenceSource::channels};
  firmware::tests::RecordingSink sink;
  firmware::StageBeats beats;
  firmware::PipelineSettings settings;
  std::atomic<bool> stop{false};
};

TEST_CASE("hang: a run goes on behind a driver that hung for six seconds, and its reader was never stuck") {
  for (const std::size_t ahead : aheads) {
    HangingRun rig(7 * second, ahead);
    rig.gate->hang_at("read", 20);
    const firmware::RunSummary summary = rig.run(100);
    CHECK(summary.ending == Ending::frames_delivered);
    CHECK(summary.frames.delivered == 100);
    CHECK(summary.frames.balanced());
    CHECK(summary.frames.drops(hal::DropReason::device_overrun) > 5000);
    CHECK(summary.recovering_ns > 5 * second);
    CHECK(rig.longest_read_ns() >= rig.settings.read_timeout_ns);
    CHECK(rig.longest_read_ns() <= rig.settings.read_timeout_ns + latest_answer_ns);
    CHECK(summary.source_counters.back().name == "hang");
    CHECK(summary.source_counters.back().count == 1);
  }
}

TEST_CASE("hang: a run whose driver hangs for good ends in its time, and says which call it is") {
  for (const std::size_t ahead : aheads) {
    HangingRun rig(std::numeric_limits<std::int64_t>::max(), ahead);
    rig.gate->hang_at("read", 20);
    const firmware::RunSummary summary = rig.run(100);
    CHECK(summary.ending == Ending::source_failed);
    REQUIRE(summary.error);
    CHECK(summary.error->code == hal::ErrorCode::disconnected);
    CHECK(summary.error->sentence.find("'read'") != std::string::npos);
    CHECK(summary.frames.delivered == 19);
    CHECK(summary.frames.balanced());
    CHECK(rig.longest_read_ns() <= rig.settings.read_timeout_ns + latest_answer_ns);
    CHECK(rig.clock->now_ns() <= 2 * second + hang_given_up_after_ns + limit_of(DeviceCall::stop).budget_ns);
    CHECK(rig.source->hang());
    rig.source.reset();
    rig.gate->release();
    rig.gate->wait_for("closed", 1);
  }
}

TEST_CASE("hang: a stop request ends a run whose driver hangs") {
  for (const std::size_t ahead : aheads) {
    HangingRun rig(std::numeric_limits<std::int64_t>::max(), ahead);
    rig.gate->hang_at("read", 20);
    rig.sink.on_write = [&](const hal::Frame&) { rig.stop = true; };
    const firmware::RunSummary summary = rig.run(0);
    CHECK(summary.ending == Ending::stop_requested);
    CHECK(summary.frames.balanced());
    rig.source.reset();
    rig.gate->release();
    rig.gate->wait_for("closed", 1);
  }
}

}  // namespace
}  // namespace compueye::device::tests
