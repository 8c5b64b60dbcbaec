#include <doctest/doctest.h>

#include "tests/firmware/pipeline/rig.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/no_threads.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;
using compueye::hal::DropReason;
using compueye::hal::ErrorCode;
using compueye::recon::Health;
using compueye::test::check_error;

TEST_CASE("every frame of a stream is delivered when nothing goes wrong") {
  for (const std::uint64_t length : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{500}}) {
    CAPTURE(length);
    Rig rig;
    rig.source.length = length;
    const RunSummary summary = rig.run();
    CHECK(summary.ending == Ending::end_of_stream);
    CHECK_FALSE(summary.failed());
    CHECK(summary.frames.produced == length);
    CHECK(summary.frames.delivered == length);
    CHECK(summary.solve.count == length);
    CHECK(summary.health.budget_used == length);
    CHECK(rig.sink.opened == 1);
    CHECK(rig.sink.closed == 1);
    CHECK(rig.sink.format.rows == 2);
    CHECK(rig.sink.format.cols == Rig::channels);
    if (length > 0) CHECK(summary.last_frame == length - 1);
  }
}

TEST_CASE("a run ends after the frames it was asked for, and gives up those on the way") {
  Rig rig;
  rig.source.length = 1000;
  rig.settings.frames = 7;
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::frames_delivered);
  CHECK(summary.frames.delivered == 7);
  CHECK(summary.last_frame == 6);
  CHECK(summary.frames.drops(DropReason::stopped) == summary.frames.produced - 7);
  CHECK(summary.frames.produced < 1000);
}

TEST_CASE("a slow solver under newest wins drops what waited, and goes on with the newest") {
  Rig rig;
  rig.settings.pacing = Pacing::newest_wins;
  rig.source.length = 200;
  Progress source_is_done;
  rig.source.before_read = [&](std::uint64_t index) {
    if (index == 200) source_is_done.reach(1);
  };
  rig.solver.before_solve = [&](std::uint64_t) { source_is_done.wait_for(1); };
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::end_of_stream);
  CHECK(summary.frames.produced == 200);
  // One frame in the solver's hands, one before it, one being corrected, and a queue of raw blocks.
  CHECK(summary.frames.drops(DropReason::superseded) >= 200 - 3 - 4);
  CHECK(summary.frames.total_dropped() == summary.frames.drops(DropReason::superseded));
  CHECK(rig.sink.frames.back() == 199);
}

TEST_CASE("back-pressure loses nothing, whoever is slow") {
  for (const int slow : {0, 1, 2}) {
    CAPTURE(slow);
    Rig rig;
    rig.source.length = 60;
    rig.settings.queue_capacity = slow == 2 ? 1 : 4;
    // Real milliseconds, because the point is which thread waits for which.
    const auto dawdle = [](auto&&...) { std::this_thread::sleep_for(std::chrono::microseconds(200)); };
    if (slow == 0) rig.source.before_read = dawdle;
    if (slow == 1) rig.solver.before_solve = dawdle;
    if (slow == 2) rig.sink.on_write = dawdle;
    const RunSummary summary = rig.run();
    CHECK(summary.frames.delivered == 60);
    CHECK(summary.frames.total_dropped() == 0);
  }
}

TEST_CASE("frames lost at the source keep their reasons") {
  Rig rig;
  rig.source.length = 30;
  rig.source.tells = {{"calm", "did not happen", 0}, {"restart", "did", 2}};
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    if (index == 4) frame.lost_before = 3;
    if (index == 9) {
      frame.lost_before = 2;
      frame.lost_as = DropReason::device_overrun;
      frame.flags.overrun = true;
    }
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.produced == 35);
  CHECK(summary.frames.delivered == 30);
  CHECK(summary.frames.drops(DropReason::transport_gap) == 3);
  CHECK(summary.frames.drops(DropReason::device_overrun) == 2);
  CHECK(summary.health.overrun_flags == 1);
  CHECK(rig.sink.frames[4] == 7);
  CHECK(summary.source_counters.size() == 2);
  CHECK(compueye::hal::text_of(summary.source_counters) == "restart 2");
}

TEST_CASE("a frame that lacks more channels than allowed is dropped, a frame that lacks fewer goes on") {
  Rig rig;
  rig.settings.correction.max_missing_share = 0.1;  // two of twenty
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    if (index == 2) frame.invalid_channels = 2;
    if (index == 5) frame.invalid_channels = 3;
    if (index == 6) frame.invalid_channels = Rig::channels;
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.drops(DropReason::too_few_channels) == 2);
  CHECK(summary.frames.delivered == 8);
  CHECK(rig.sink.frames == std::vector<std::uint64_t>{0, 1, 2, 3, 4, 7, 8, 9});
  CHECK(summary.masked_min == 0);
  CHECK(summary.masked_max == Rig::channels);
}

TEST_CASE("what the solver calls invalid is not published") {
  Rig rig;
  rig.solver.health_of = [](std::uint64_t call) {
    if (call == 3) return Health::invalid;
    return call % 2 == 0 ? Health::converged : Health::budget_used;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.drops(DropReason::solver_invalid) == 1);
  CHECK(rig.sink.frames == std::vector<std::uint64_t>{0, 1, 2, 4, 5, 6, 7, 8, 9});
  CHECK(summary.health.converged == 5);
  CHECK(summary.health.budget_used == 4);
  CHECK(summary.solve.count == 10);
}

TEST_CASE("a sink that fails ends the run with its error and closes what was begun") {
  Rig rig;
  rig.source.length = 1000;
  rig.sink.refuses = {3};
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::sink_failed);
  REQUIRE(summary.error.has_value());
  CHECK(summary.error->text() == "out/3.png: the disk is full");
  CHECK(summary.frames.delivered == 3);
  CHECK(summary.frames.drops(DropReason::sink_failed) == 1);
  CHECK(summary.frames.drops(DropReason::stopped) == summary.frames.produced - 4);
  CHECK(rig.sink.closed == 1);
}

TEST_CASE("a sink may be allowed to fail now and then") {
  Rig rig;
  rig.settings.stop_on_sink_failure = false;
  rig.sink.refuses = {0, 3};
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::end_of_stream);
  CHECK_FALSE(summary.failed());
  REQUIRE(summary.sink_error.has_value());
  CHECK(summary.sink_error->code == ErrorCode::no_space);
  CHECK(summary.frames.drops(DropReason::sink_failed) == 2);
  CHECK(summary.frames.delivered == 8);
}

TEST_CASE("a sink that cannot finish its files fails the run, though every frame was taken") {
  Rig rig;
  rig.sink.may_close = false;
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::sink_failed);
  CHECK(summary.error->place == "out/x.npy");
  CHECK(summary.frames.delivered == 10);
}

TEST_CASE("a stop in the middle counts what was on the way as stopped") {
  Rig rig;
  rig.source.length = 1'000'000;
  rig.sink.on_write = [&](const compueye::hal::Frame& frame) {
    if (frame.frame == 20) rig.stop = true;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::stop_requested);
  CHECK_FALSE(summary.failed());
  CHECK(summary.frames.delivered == 21);
  CHECK(summary.frames.drops(DropReason::stopped) == summary.frames.produced - 21);
}

TEST_CASE("a stop is noticed while every stage waits for a silent source") {
  Rig rig;
  rig.settings.silence_limit_ns = 0;
  rig.source.ending = ScriptEnd::silence;
  rig.source.before_read = [&](std::uint64_t index) {
    static_cast<void>(index);
    if (rig.clock.now_ns() > 60'000'000'000) rig.stop = true;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::stop_requested);
  CHECK(summary.frames.produced == 10);
  CHECK(summary.health.read_timeouts >= 600);
}

TEST_CASE("a stop that was asked for before the run leaves an empty and balanced run") {
  Rig rig;
  rig.stop = true;
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::stop_requested);
  CHECK(summary.frames.delivered == 0);
}

TEST_CASE("a source that goes away ends the run with its error after the last frame it gave") {
  Rig rig;
  rig.source.ending = ScriptEnd::disconnect;
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::source_failed);
  REQUIRE(summary.error.has_value());
  CHECK(summary.error->code == ErrorCode::disconnected);
  CHECK(summary.error->text() == "scripted-1: the eye was unplugged");
  CHECK(summary.frames.delivered == 10);
}

TEST_CASE("a source or a sink that has no memory fails, and nothing is thrown out of a thread") {
  Rig rig;
  rig.source.before_read = [](std::uint64_t index) {
    if (index == 5) throw std::bad_alloc();
  };
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::source_failed);
  REQUIRE(summary.error.has_value());
  check_error(*summary.error, ErrorCode::no_space, "source", {});
  CHECK(summary.frames.delivered == 5);

  Rig other;
  other.sink.on_write = [](const compueye::hal::Frame&) { throw std::bad_alloc(); };
  auto pipeline = Pipeline::create(other.settings, other.source, other.solver, other.sink, other.clock);
  REQUIRE(pipeline.has_value());
  const RunSummary unwritten = pipeline->run(other.stop);
  CHECK(unwritten.ending == Ending::sink_failed);
  REQUIRE(unwritten.error.has_value());
  check_error(*unwritten.error, ErrorCode::no_space, "sink", {});
  CHECK(unwritten.frames.delivered == 0);
}

TEST_CASE("a run that gets no threads says so, and the next one has them") {
  Rig rig;
  auto pipeline = Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock);
  REQUIRE(pipeline.has_value());
  {
    const compueye::test::NoThreads refused;
    const RunSummary summary = rig.checked(pipeline->run(rig.stop));
    CHECK(summary.ending == Ending::internal_failure);
    REQUIRE(summary.error.has_value());
    check_error(*summary.error, ErrorCode::no_space, "pipeline", {});
  }
  CHECK(rig.checked(pipeline->run(rig.stop)).frames.delivered == 10);
}

TEST_CASE("a source that reports an interruption stops the run without an error") {
  Rig rig;
  rig.source.ending = ScriptEnd::interrupted;
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::stop_requested);
  CHECK_FALSE(summary.failed());
}

TEST_CASE("a source that falls silent has failed, short pauses are only counted") {
  Rig rig;
  rig.settings.read_timeout_ns = 10'000'000;
  rig.settings.silence_limit_ns = 100'000'000;
  rig.source.ending = ScriptEnd::silence;
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.timeouts_before = index % 3 == 2 ? 9 : 0;
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::source_failed);
  REQUIRE(summary.error.has_value());
  check_error(*summary.error, ErrorCode::timeout, "scripted-1", {"100"});
  CHECK(summary.frames.delivered == 10);
  CHECK(summary.health.read_timeouts == 3 * 9 + 10);
}

TEST_CASE("a source that recovers is waited for, as long as it says so, and the summary tells how long that was") {
  Rig rig;
  rig.settings.read_timeout_ns = 10'000'000;
  rig.settings.silence_limit_ns = 100'000'000;
  rig.source.ending = ScriptEnd::silence;
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.timeouts_before = index == 5 ? 3000 : 0;
    return frame;
  };
  rig.source.recovers = [&] { return rig.clock.now_ns() <= 30'000'000'000; };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.delivered == 10);
  CHECK(summary.recovering_ns == 30'000'000'000);
  // Silence that is none of it has its limit still.
  CHECK(summary.ending == Ending::source_failed);
  REQUIRE(summary.error.has_value());
  check_error(*summary.error, ErrorCode::timeout, "scripted-1", {"100"});
}

TEST_CASE("what a source finds out when it is stopped is in the books of the run") {
  Rig rig;
  rig.source.frames_lost_at_stop = 7;
  const RunSummary summary = rig.run();
  CHECK(summary.frames.produced == 17);
  CHECK(summary.frames.drops(DropReason::stopped) == 7);
  CHECK(summary.stages.source.produced == 17);
}

TEST_CASE("a source or a sink that does not begin leaves the other alone") {
  Rig rig;
  rig.source.may_start = false;
  rig.source.tells = {{"absent", "not there", 5}};
  RunSummary summary = rig.run();
  CHECK(compueye::hal::text_of(summary.source_counters) == "absent 5");
  CHECK(summary.ending == Ending::source_failed);
  check_error(*summary.error, ErrorCode::io, "scripted-1", {});
  CHECK(rig.sink.closed == rig.sink.opened);

  Rig other;
  other.sink.may_open = false;
  summary = other.run();
  CHECK(summary.ending == Ending::sink_failed);
  CHECK(summary.error->place == "out");
  CHECK(summary.frames.produced == 0);
}

TEST_CASE("books of a source that do not balance are an internal failure, not a silent loss") {
  Rig rig;
  rig.source.lies_about_its_account = true;
  auto pipeline = Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock);
  REQUIRE(pipeline.has_value());
  const RunSummary summary = pipeline->run(rig.stop);
  CHECK(summary.ending == Ending::internal_failure);
  REQUIRE(summary.error.has_value());
  check_error(*summary.error, ErrorCode::mismatch, "frame accounting", {"source"});
}

TEST_CASE("a pipeline, and another on the same source, can run again from the beginning") {
  Rig rig;
  auto pipeline = Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock);
  REQUIRE(pipeline.has_value());
  for (int run = 0; run < 3; ++run) {
    const RunSummary summary = rig.checked(pipeline->run(rig.stop));
    CHECK(summary.frames.delivered == 10);
    CHECK(rig.sink.frames.front() == 0);
  }
  rig.settings.frames = 2;
  CHECK(rig.run().frames.delivered == 2);
  rig.settings.frames = 0;
  CHECK(rig.run().frames.delivered == 10);
  CHECK(rig.sink.opened == 5);
  CHECK(rig.sink.closed == 5);
}
