#include <doctest/doctest.h>

#include <limits>

#include "tests/firmware/supervisor/scripted_run.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/source_folder.hpp"

namespace {

using namespace compueye::firmware;
using compueye::test::ms;
using compueye::test::ScriptedRun;
using compueye::test::second;

TEST_CASE("docs/service.md has the tables of states") {
  const std::string page = compueye::test::bytes_of(compueye::test::source_path("docs/service.md"));
  for (const std::string& table : {picture_reference(), trouble_reference()}) {
    CHECK_MESSAGE(page.find(table) != std::string::npos, "docs/service.md should hold:\n" << table);
  }
}

TEST_CASE("a picture is live, held and taken away at the limits, to the millisecond") {
  ScriptedRun run;
  CHECK(run.health().picture == PictureState::starting);
  CHECK(run.health().trouble == Trouble::none);
  run.frames(50);
  CHECK(run.health().picture == PictureState::live);
  CHECK(run.health().trouble == Trouble::none);

  const std::int64_t last = run.now_ns;
  const auto after = [&](std::int64_t ns) {
    run.now_ns = last + ns;
    return run.health();
  };
  CHECK(after(250 * ms).picture == PictureState::live);
  CHECK(after(250 * ms + 1).picture == PictureState::held);
  CHECK(after(250 * ms + 1).trouble == Trouble::silent);
  CHECK(after(2000 * ms).picture == PictureState::held);
  CHECK(after(2000 * ms + 1).picture == PictureState::blank);
  CHECK(after(3600 * second).picture == PictureState::blank);
  CHECK(after(3600 * second).alive());
}

TEST_CASE("pictures that come seldom are not held between two of them") {
  ScriptedRun run;
  run.frames(3, 4 * second);
  const std::int64_t last = run.now_ns;
  run.now_ns = last + 12 * second;
  CHECK(run.health().picture == PictureState::live);
  run.now_ns = last + 12 * second + 1;
  CHECK(run.health().picture == PictureState::held);
  run.now_ns = last + 40 * second;
  CHECK(run.health().picture == PictureState::held);
  run.now_ns = last + 40 * second + 1;
  CHECK(run.health().picture == PictureState::blank);
}

TEST_CASE("before the first picture nothing is held, whatever keeps it away") {
  ScriptedRun run;
  run.now_ns += 3600 * second;
  run.counters.recovering = true;
  CHECK(run.health().picture == PictureState::starting);
  CHECK(run.health().trouble == Trouble::recovering);
  CHECK(run.health().alive());
}

TEST_CASE("an eye that is unplugged for twenty seconds is recovering, and no reason to restart") {
  ScriptedRun run;
  run.frames(50);
  run.counters.recovering = true;
  for (int i = 0; i < 2000; ++i) {
    run.now_ns += 10 * ms;
    // read() times out every 100 ms meanwhile.
    run.stage(Stage::acquire) = {.working = i % 10 != 0, .since_ns = run.now_ns - (i % 10) * 10 * ms, .ended = 100};
    CHECK(run.health().alive());
  }
  CHECK(run.health().trouble == Trouble::recovering);
  CHECK(run.health().picture == PictureState::blank);
  CHECK(run.health().sentence() ==
        "picture blank, the last one came 20.0 s ago: the eye is lost, and the driver is getting it back");
  run.counters.recovering = false;
  run.frames(1);
  CHECK(run.health().picture == PictureState::live);
}

TEST_CASE("each stage that does not come back from its work is stuck, by name, at the limit") {
  for (std::size_t i = 0; i < stage_count; ++i) {
    const auto which = static_cast<Stage>(i);
    CAPTURE(name(which));
    ScriptedRun run;
    run.frames(50);
    const std::int64_t since = run.now_ns;
    run.stage(which).working = true;
    run.now_ns = since + 10 * second;
    CHECK(run.health().alive());
    run.now_ns += 1;
    const Health health = run.health();
    CHECK_FALSE(health.alive());
    CHECK(health.trouble == Trouble::stuck);
    CHECK(health.stage == which);
    CHECK(health.sentence().find(name(which)) != std::string::npos);
    // Not because an eye is lost as well.
    run.counters.recovering = true;
    CHECK(run.health().trouble == Trouble::stuck);
  }
}

TEST_CASE("of several stuck stages the one nearest to the screen is named, since it holds the others") {
  ScriptedRun run;
  run.frames(50);
  run.stage(Stage::reconstruct).working = run.stage(Stage::publish).working = run.stage(Stage::acquire).working = true;
  run.now_ns += 11 * second;
  CHECK(run.health().stage == Stage::publish);
}

TEST_CASE("a stage whose work takes long is given four times that, and its first piece ten times the limit") {
  ScriptedRun run;
  run.frames(2);
  StageProgress& solve = run.stage(Stage::reconstruct);
  solve = {.working = true, .since_ns = run.now_ns, .longest_ns = 6 * second, .ended = 2};
  run.now_ns += 24 * second;
  CHECK(run.health().alive());
  CHECK(run.health().trouble == Trouble::slow);
  CHECK(run.health().stage == Stage::reconstruct);
  run.now_ns += 1;
  CHECK(run.health().trouble == Trouble::stuck);

  ScriptedRun fresh;
  fresh.stage(Stage::reconstruct).working = true;
  fresh.now_ns += 100 * second;
  CHECK(fresh.health().alive());
  fresh.now_ns += 1;
  CHECK(fresh.health().trouble == Trouble::stuck);
}

TEST_CASE("a livelock, frames that are all thrown away as faulty, needs a restart; one that is over does not") {
  ScriptedRun run;
  run.frames(50);
  const std::int64_t since = run.now_ns;
  const auto dropped_until = [&](std::int64_t ns) {
    run.now_ns = since + ns;
    run.stage(Stage::correct).fruitless_from_ns = since;
    run.stage(Stage::correct).fruitless_to_ns = run.now_ns;
  };
  dropped_until(10 * second);
  CHECK(run.health().alive());
  dropped_until(10 * second + 1);
  CHECK(run.health().trouble == Trouble::fruitless);
  CHECK(run.health().stage == Stage::correct);
  // Nothing comes at all any more: the eye is silent, and a restart is not the cure.
  run.now_ns += 10 * second;
  CHECK(run.health().alive());
  run.frames(1);
  CHECK(run.health().picture == PictureState::live);
}

TEST_CASE("frames whose channels are too few to see are the scene's doing") {
  ScriptedRun run;
  run.frames(50);
  for (int i = 0; i < 3000; ++i) {
    run.now_ns += 10 * ms;
    StageProgress& correct = run.stage(Stage::correct);
    correct = {.since_ns = run.now_ns, .longest_ns = ms, .ended = correct.ended + 1};
  }
  CHECK(run.health().trouble == Trouble::unusable);
  CHECK(run.health().picture == PictureState::blank);
  CHECK(run.health().alive());
}

TEST_CASE("late is what many of the last pictures were, and degraded what they lack") {
  ScriptedRun run;
  run.frames(40);
  run.frames(7, 10 * ms, true);
  CHECK(run.health().picture == PictureState::live);
  run.frames(1, 10 * ms, true);
  CHECK(run.health().picture == PictureState::late);
  CHECK(run.health().trouble == Trouble::deadline);
  run.frames(24);
  CHECK(run.health().picture == PictureState::late);
  run.frames(1);
  CHECK(run.health().picture == PictureState::live);
  run.counters.left_out = 3;
  CHECK(run.health().picture == PictureState::degraded);
  CHECK(run.health().sentence() == "picture degraded: channels are left out (3)");
  run.counters.misfit = 94.0;
  CHECK(run.health().trouble == Trouble::misfit);
}

TEST_CASE("a check of the eye holds the picture and is called so") {
  ScriptedRun run;
  run.frames(50);
  run.counters.checking = true;
  run.now_ns += 300 * ms;
  CHECK(run.health().picture == PictureState::held);
  CHECK(run.health().trouble == Trouble::checking);
}

TEST_CASE("a clock that steps back, or numbers at the end of their range, break nothing") {
  ScriptedRun run;
  run.frames(50);
  run.now_ns -= 3600 * second;
  CHECK(run.health().picture == PictureState::live);
  CHECK(run.health().picture_ns == 0);
  run.now_ns = std::numeric_limits<std::int64_t>::max();
  run.counters.interval_ns = std::numeric_limits<std::int64_t>::max();
  run.stage(Stage::reconstruct).longest_ns = std::numeric_limits<std::int64_t>::max();
  CHECK(run.health().picture == PictureState::blank);
}

}  // namespace
