#include <doctest/doctest.h>

#include "tests/firmware/pipeline/rig.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye::firmware;
using namespace compueye::firmware::tests;
using compueye::hal::DropReason;
using compueye::hal::ErrorCode;
using compueye::test::check_error;

TEST_CASE("frames taken with another configuration are corrupt, and good again when it returns") {
  Rig rig;
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.config_id = index == 3 || index == 4 ? 9U : 1U;
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.drops(DropReason::corrupt) == 2);
  CHECK(summary.health.config_mismatches == 2);
  CHECK(rig.sink.frames == std::vector<std::uint64_t>{0, 1, 2, 5, 6, 7, 8, 9});
}

TEST_CASE("a device that leaves its configuration for good ends the run and says so") {
  Rig rig;
  rig.settings.config_patience = 5;
  rig.source.length = 100'000;
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    // Four in a row are forgiven.
    const bool brief = index >= 10 && index < 14;
    frame.config_id = brief || index >= 20 ? 9U : 1U;
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.ending == Ending::source_failed);
  REQUIRE(summary.error.has_value());
  check_error(*summary.error, ErrorCode::mismatch, "configuration", {"9", "1"});
  CHECK(summary.frames.delivered == 16);
  CHECK(summary.health.config_mismatches == 9);
}

TEST_CASE("every run takes the configuration of its own first frame") {
  Rig rig;
  std::uint32_t config_id = 1;
  rig.source.script = [&](std::uint64_t) {
    ScriptedFrame frame;
    frame.config_id = config_id;
    return frame;
  };
  auto pipeline = Pipeline::create(rig.settings, rig.source, rig.solver, rig.sink, rig.clock);
  REQUIRE(pipeline.has_value());
  for (config_id = 1; config_id <= 3; ++config_id) {
    CHECK(rig.checked(pipeline->run(rig.stop)).frames.delivered == 10);
  }
}

TEST_CASE("an expected configuration is demanded from the first frame on") {
  Rig rig;
  rig.settings.correction.expected_config_id = 2;
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.config_id = index < 4 ? 1U : 2U;
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.drops(DropReason::corrupt) == 4);
  CHECK(summary.frames.delivered == 6);
}

TEST_CASE("blocks of another size and numbers that do not rise are corrupt") {
  Rig rig;
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.short_by = index == 2 ? 1 : 0;
    frame.repeats_number = index == 6;
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.drops(DropReason::corrupt) == 2);
  CHECK(rig.sink.frames == std::vector<std::uint64_t>{0, 1, 3, 4, 5, 7, 8, 9});
}

TEST_CASE("saturated and dead channels reach the solver with weight zero") {
  Rig rig;
  rig.settings.correction.max_missing_share = 0.2;
  rig.settings.correction.dead_channels = {4};
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.saturated_channels = index == 7 ? 2 : 0;
    return frame;
  };
  std::vector<float> weights_of_dead;
  std::vector<float> weights_of_last;
  rig.sink.on_write = [&](const compueye::hal::Frame& frame) {
    // Channel c is ommatidium 19 - c; the second row of the picture holds the weights.
    weights_of_dead.push_back(frame.pixels[Rig::channels + 19 - 4]);
    weights_of_last.push_back(frame.pixels[Rig::channels + 19 - 19]);
    if (!Rig::belongs(frame)) ++rig.wrong_pictures;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.delivered == 10);
  CHECK(weights_of_dead == std::vector<float>(10, 0.0F));
  CHECK(weights_of_last == std::vector<float>{1, 1, 1, 1, 1, 1, 1, 0, 1, 1});
  CHECK(summary.masked_min == 1);
  CHECK(summary.masked_max == 3);
  CHECK(summary.health.saturated_frames == 1);
}

TEST_CASE("flags of frames are counted and do not change what is published") {
  Rig rig;
  rig.source.script = [](std::uint64_t index) {
    ScriptedFrame frame;
    frame.flags.dark = index < 3;
    frame.flags.time_ok = index != 8;
    return frame;
  };
  const RunSummary summary = rig.run();
  CHECK(summary.frames.delivered == 10);
  CHECK(summary.health.dark_frames == 3);
  CHECK(summary.health.untrusted_times == 1);
}
