#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "calib/patterns/pattern_family.hpp"
#include "calib/session/session_machine.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using calib::Need, calib::Stage;

namespace {

using compueye::test::ms;
constexpr int side = 8, channels = 16;

/// An eye of 16 channels, each seeing four rows of pixels beside each other, behind a light that takes its time, on a
/// clock of its own.
struct TimedBench {
  calib::SessionPlan plan;
  std::int64_t now_ns = 5 * ms, period_ns = 2 * ms, light_delay_ns = 30 * ms, way_ns = 3 * ms;
  double gain = 100.0, dark = 40.0, display_black = 0.01;
  std::uint64_t frame = 0;
  hal::Image shown;  // as seen from changed_ns on; empty: no light
  hal::Image before;
  std::int64_t changed_ns = 0;
  std::vector<std::int32_t> codes = std::vector<std::int32_t>(channels, 0);
  std::vector<std::uint8_t> valid = std::vector<std::uint8_t>(channels, 1);
  std::vector<calib::Capture> stored;
  std::function<void(hal::SampleBlock&)> spoil;  // what happens to a frame on its way
  std::int64_t hold_up_from = -1;  // capture from which on the reader is held up at every change of light; -1: never
  std::vector<std::pair<hal::SampleBlock, std::vector<std::int32_t>>> held_up;

  TimedBench() {
    plan.warm_up_s = 0.1;
    plan.dark_frames = plan.black_frames = plan.flat_frames = 4;
    plan.ramp_steps = 2;
    plan.ramp_frames = 2;
    plan.patterns = 40;
    plan.settle_ms = 100;
    plan.least_signal_lsb = 50;
  }

  [[nodiscard]] double light_of(const hal::Image& picture, int channel) const {
    if (picture.rows == 0) return 0.0;
    double sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      const int pixel = channel * 4 + k;
      sum +=
          static_cast<double>(picture.pixels[static_cast<std::size_t>(pixel)]) * (1.0 - display_black) + display_black;
    }
    return gain * sum;
  }

  void show(const calib::Wanted& wanted) {
    before = shown;
    shown = calib::picture_of(wanted, side, side).value();
    changed_ns = now_ns + light_delay_ns;
  }

  /// The next frame, read when its exposure is over and it has come.
  hal::SampleBlock read() {
    const std::int64_t begun = now_ns;
    for (int c = 0; c < channels; ++c) {
      codes[static_cast<std::size_t>(c)] =
          static_cast<std::int32_t>(std::min(dark + light_of(begun >= changed_ns ? shown : before, c), 4095.0));
    }
    now_ns += period_ns;
    hal::SampleBlock block;
    block.codes = codes;
    block.valid = valid;
    block.bits = 12;
    block.frame = frame++;
    block.t_ns = begun + 1000 * ms;
    if (spoil) spoil(block);
    return block;
  }

  /// Frames of the old light that are read long after the new one has settled: the reader was held up.
  hal::Result<void> read_late(calib::SessionMachine& machine) {
    for (const auto& [block, seen] : held_up) {
      hal::SampleBlock late = block;
      late.codes = seen;
      if (auto told = machine.saw(late, now_ns + way_ns); !told) return told;
    }
    held_up.clear();
    return {};
  }

  hal::Result<void> drive(calib::SessionMachine& machine, std::int64_t most_commits = 1'000'000) {
    while (machine.need() != Need::nothing && most_commits > 0) {
      if (machine.need() == Need::commit) --most_commits;
      if (auto done = step(machine); !done) return done;
    }
    return {};
  }

  /// What the machine needs next.
  hal::Result<void> step(calib::SessionMachine& machine) {
    if (machine.need() == Need::light) {
      const bool late = hold_up_from >= 0 && machine.progress(0).taken >= hold_up_from;
      for (int k = 0; k < 4 && late; ++k) {
        const hal::SampleBlock block = read();
        held_up.emplace_back(block, codes);
      }
      show(machine.wanted());
      machine.lit(now_ns, now_ns + ms);  // which the light is wrong about
      if (late) now_ns += 500 * ms;
      if (auto told = read_late(machine); !told) return told;
    } else if (machine.need() == Need::frame) {
      const auto block = read();
      const auto seen = machine.saw(block, now_ns + way_ns);
      if (!seen) return seen;
    } else {
      stored.push_back(machine.capture());
      machine.committed(now_ns);
    }
    return {};
  }

  calib::SessionMachine machine(const calib::Resumed& resumed = {}) {
    return calib::SessionMachine::create(plan, {channels, 12, 0}, side, side, resumed, now_ns).value();
  }
};

}  // namespace

TEST_CASE("a session captures its whole schedule, each under its own light alone") {
  TimedBench bench;
  auto machine = bench.machine();
  REQUIRE(bench.drive(machine).has_value());
  const auto schedule = calib::capture_schedule(bench.plan, side, side);
  REQUIRE(bench.stored.size() == schedule.size());
  for (std::size_t k = 0; k < schedule.size(); ++k) {
    CAPTURE(k);
    const calib::Capture& taken = bench.stored[k];
    CHECK(taken.stage == name(schedule[k].stage));
    CHECK(taken.frames == schedule[k].frames);
    CHECK(taken.repeat == 0);
    const hal::Image picture = calib::picture_of(schedule[k], side, side).value();
    for (int c = 0; c < channels; ++c) {
      const auto code = static_cast<std::int32_t>(bench.dark + bench.light_of(picture, c));
      CHECK(taken.codes[static_cast<std::size_t>(c)] == taken.frames * code);
    }
  }
  const auto progress = machine.progress(bench.now_ns);
  CHECK(progress.taken == progress.of);
  // The light takes 30 ms and not the one that it says; three times that is waited.
  CHECK(progress.settle_ms >= 84.0);
  CHECK(progress.settle_ms <= 108.0);
  CHECK(progress.signal_lsb == doctest::Approx(400.0));
}

TEST_CASE("references, darks and held-out patterns come as often as the plan says, and a reference is the last") {
  calib::SessionPlan plan;
  plan.patterns = 256;
  const auto schedule = calib::capture_schedule(plan, 16, 16);
  const auto count = [&](Stage stage) {
    return std::count_if(schedule.begin(), schedule.end(), [&](const auto& w) { return w.stage == stage; });
  };
  CHECK(count(Stage::pattern) + count(Stage::held_out) == 256);
  CHECK(count(Stage::held_out) == 256 / 5);
  CHECK(count(Stage::reference) == 256 / 16 + 1);
  CHECK(count(Stage::interleaved_dark) == 256 / 64 + 1);
  CHECK(count(Stage::dark) == 64);
  CHECK(count(Stage::ramp) == count(Stage::ramp_rest));
  CHECK(schedule[schedule.size() - 2].stage == Stage::reference);
  // A ramp's two parts are the white picture.
  for (std::size_t k = 2; k < schedule.size(); ++k) {
    if (schedule[k].stage != Stage::ramp_rest) continue;
    CHECK(schedule[k - 1].stage == Stage::ramp_white);
    const auto a = calib::picture_of(schedule[k - 2], 16, 16).value(),
               b = calib::picture_of(schedule[k], 16, 16).value();
    for (std::size_t n = 0; n < a.pixels.size(); ++n) CHECK(a.pixels[n] + b.pixels[n] == 1.0F);
  }
  plan.family = "raster";
  const auto few = calib::capture_schedule(plan, 4, 4);
  plan.family = "dct";  // which the schedule does not look at any more
  CHECK(std::count_if(few.begin(), few.end(), [](const auto& w) { return w.family == "raster"; }) == 16);
}

TEST_CASE("a session that was cut off goes on after the last capture that was stored") {
  TimedBench whole;
  auto machine = whole.machine();
  REQUIRE(whole.drive(machine).has_value());
  for (const std::int64_t cut : {1, 12, 17, 30}) {
    CAPTURE(cut);
    TimedBench bench;
    auto first = bench.machine();
    REQUIRE(bench.drive(first, cut).has_value());
    calib::Resumed resumed{cut, {}};
    for (const auto& capture : bench.stored) {
      if (capture.family == "all-on") resumed.reference = capture;
    }
    auto second = bench.machine(resumed);
    REQUIRE(bench.drive(second).has_value());
    REQUIRE(bench.stored.size() == whole.stored.size());
    for (std::size_t k = 0; k < whole.stored.size(); ++k) {
      CHECK(bench.stored[k].stage == whole.stored[k].stage);
      CHECK(bench.stored[k].pattern == whole.stored[k].pattern);
      CHECK(bench.stored[k].codes == whole.stored[k].codes);
    }
  }
}

TEST_CASE("a session does not go on before another light than it was begun with") {
  TimedBench bench;
  auto first = bench.machine();
  REQUIRE(bench.drive(first, 30).has_value());
  calib::Resumed resumed{30, {}};
  for (const auto& capture : bench.stored) {
    if (capture.family == "all-on") resumed.reference = capture;
  }
  bench.gain *= 0.9;
  auto second = bench.machine(resumed);
  test::check_error(bench.drive(second), hal::ErrorCode::mismatch, "reference", {"10", "5"});
  CHECK(bench.stored.size() == 30);

  // Within the share that a lamp may change by, but not in all channels alike: another eye, or one that was moved.
  bench.gain /= 0.9;
  bench.spoil = [&](hal::SampleBlock&) {  // which shows these codes
    for (std::size_t c = 0; c < bench.codes.size(); c += 2) bench.codes[c] += (bench.codes[c] - 40) / 16;
  };
  auto third = bench.machine(resumed);
  test::check_error(bench.drive(third), hal::ErrorCode::mismatch, "reference", {"1", "--give-up"});
  CHECK(bench.stored.size() == 30);
}

TEST_CASE("what is lost, overrun, saturated or of other settings is taken again, and counted") {
  struct Case {
    calib::Rejection reason;
    std::function<void(hal::SampleBlock&, TimedBench&)> spoil;
  };
  const std::vector<Case> cases{
      {calib::Rejection::gap, [](hal::SampleBlock& b, TimedBench& bench) { b.frame = bench.frame++; }},
      {calib::Rejection::overrun, [](hal::SampleBlock& b, TimedBench&) { b.flags.overrun = true; }},
      {calib::Rejection::configuration, [](hal::SampleBlock& b, TimedBench&) { b.config_id = 7; }},
      {calib::Rejection::saturated,
       [](hal::SampleBlock&, TimedBench& bench) { std::fill(bench.codes.begin(), bench.codes.end(), 4095); }},
  };
  for (const Case& each : cases) {
    CAPTURE(name(each.reason));
    TimedBench bench, undisturbed;
    bench.plan.frames = undisturbed.plan.frames = 3;
    auto whole = undisturbed.machine();
    REQUIRE(undisturbed.drive(whole).has_value());
    int until_next = 0;
    auto machine = bench.machine();
    bench.spoil = [&](hal::SampleBlock& block) {
      const bool within = machine.progress(0).taken >= 12;
      if (within && ++until_next % 23 == 0) each.spoil(block, bench);
    };
    REQUIRE(bench.drive(machine).has_value());
    CHECK(machine.progress(0).rejected[static_cast<std::size_t>(each.reason)] > 0);
    REQUIRE(bench.stored.size() == undisturbed.stored.size());
    std::uint64_t repeats = 0;
    for (std::size_t k = 0; k < bench.stored.size(); ++k) {
      CHECK(bench.stored[k].codes == undisturbed.stored[k].codes);
      repeats += static_cast<std::uint64_t>(bench.stored[k].repeat);
    }
    CHECK(repeats == machine.progress(0).rejected[static_cast<std::size_t>(each.reason)]);
  }
}

TEST_CASE("an eye that was lost and found sees its light anew, and what was being taken is taken again") {
  TimedBench whole;
  whole.plan.frames = 3;
  auto undisturbed = whole.machine();
  REQUIRE(whole.drive(undisturbed).has_value());
  // Frames at which it is lost: in the warm-up, while light falls and rises, at the levels, and in captures.
  for (const std::uint64_t lost_at : {10U, 60U, 70U, 130U, 250U, 900U, 2000U}) {
    CAPTURE(lost_at);
    TimedBench bench;
    bench.plan.frames = 3;
    auto machine = bench.machine();
    while (machine.need() != Need::nothing) {
      if (machine.need() == Need::frame && bench.frame == lost_at) {
        // A lamp of the device goes out with it, and no number is missing.
        bench.shown = bench.before = {};
        bench.now_ns += 3000 * ms;
        bench.read();
        REQUIRE(machine.recovered(bench.now_ns).has_value());
      }
      REQUIRE(bench.step(machine).has_value());
    }
    CHECK(bench.frame > lost_at);
    REQUIRE(bench.stored.size() == whole.stored.size());
    for (std::size_t k = 0; k < whole.stored.size(); ++k) CHECK(bench.stored[k].codes == whole.stored[k].codes);
    const auto progress = machine.progress(0);
    CHECK(progress.rejected[static_cast<std::size_t>(calib::Rejection::recovered)] <= 1);
    CHECK(progress.settle_ms >= 84.0);
    CHECK(progress.settle_ms <= 108.0);
  }
}

TEST_CASE("frames of the light before are told by when they were exposed, however late they are read") {
  TimedBench whole, late;
  late.hold_up_from = 8;
  auto undisturbed = whole.machine(), machine = late.machine();
  REQUIRE(whole.drive(undisturbed).has_value());
  REQUIRE(late.drive(machine).has_value());
  REQUIRE(late.stored.size() == whole.stored.size());
  for (std::size_t k = 0; k < whole.stored.size(); ++k) CHECK(late.stored[k].codes == whole.stored[k].codes);
}

TEST_CASE("a channel that means nothing in one frame of a capture means nothing in the capture") {
  TimedBench bench;
  bench.plan.frames = 3;
  auto machine = bench.machine();
  int frames = 0;
  std::vector<std::uint8_t> valid(channels, 1);
  bench.spoil = [&](hal::SampleBlock& block) {
    const bool within = machine.progress(0).taken >= 20;
    valid[5] = within && ++frames % 11 == 0 ? 0 : 1;
    block.valid = valid;
  };
  REQUIRE(bench.drive(machine).has_value());
  int without = 0;
  for (const calib::Capture& each : bench.stored) {
    for (std::size_t c = 0; c < each.valid.size(); ++c) CHECK((each.valid[c] == 1 || c == 5));
    without += each.valid[5] == 0 ? 1 : 0;
  }
  CHECK(without > 3);
  CHECK(without < static_cast<int>(bench.stored.size()) / 2);
}

TEST_CASE("a session gives up on what never comes whole, and says why") {
  TimedBench bench;
  bench.plan.most_retakes = 3;
  auto machine = bench.machine();
  bench.spoil = [&](hal::SampleBlock& block) { block.config_id = machine.progress(0).taken >= 5 ? 9 : 0; };
  test::check_error(bench.drive(machine), hal::ErrorCode::mismatch, "black", {"5", "4"});
  CHECK(bench.stored.size() == 5);
}

TEST_CASE("too much light, too little and light that does not settle are refused before anything is stored") {
  const auto refused = [](const test::Named& named, auto change) {
    TimedBench bench;
    change(bench);
    auto machine = bench.machine();
    test::check_error(bench.drive(machine), hal::ErrorCode::out_of_range, "light", named);
    CHECK(bench.stored.empty());
  };
  refused({"16"}, [](TimedBench& b) { b.gain = 2000.0; });
  refused({"12", "50"}, [](TimedBench& b) { b.gain = 3.0; });
  refused({"100"}, [](TimedBench& b) { b.light_delay_ns = 90 * ms; });
}

TEST_CASE("a device that begins anew is believed about its time no more than before") {
  TimedBench bench;
  auto machine = bench.machine();
  std::int64_t back_ns = 0;
  bench.spoil = [&](hal::SampleBlock& block) {
    if (machine.progress(0).taken == 20) back_ns = 900 * ms;
    block.t_ns -= back_ns;
  };
  TimedBench whole;
  auto undisturbed = whole.machine();
  REQUIRE(whole.drive(undisturbed).has_value());
  REQUIRE(bench.drive(machine).has_value());
  REQUIRE(bench.stored.size() == whole.stored.size());
  for (std::size_t k = 0; k < whole.stored.size(); ++k) CHECK(bench.stored[k].codes == whole.stored[k].codes);
}

TEST_CASE("a device whose time falls behind is told so when frames cannot be told apart any more, and not before") {
  for (const std::int64_t percent : {90, 1}) {
    CAPTURE(percent);
    TimedBench bench;
    auto machine = bench.machine();
    bench.spoil = [&](hal::SampleBlock& block) { block.t_ns -= (bench.now_ns - bench.period_ns) / 100 * percent; };
    const auto done = bench.drive(machine);
    CHECK(done.has_value() == (percent == 1));
    if (!done) test::check_error(done, hal::ErrorCode::mismatch, "device time", {});
  }
}

TEST_CASE("a plan that makes no sense is refused by the name of its setting") {
  const auto refused = [](hal::ErrorCode code, const std::string& place, const test::Named& named, auto change) {
    calib::SessionPlan plan;
    change(plan);
    test::check_error(calib::SessionMachine::create(plan, {channels, 12, 0}, side, side, {}, 0), code, place, named);
  };
  using P = calib::SessionPlan;
  const auto range = hal::ErrorCode::out_of_range;
  refused(range, "plan.warm_up_s", {"-1"}, [](P& p) { p.warm_up_s = -1.0; });
  refused(range, "plan.warm_up_s", {"nan"}, [](P& p) { p.warm_up_s = std::nan(""); });
  refused(range, "plan.dark_frames", {"1", "2"}, [](P& p) { p.dark_frames = 1; });
  refused(range, "plan.held_out_every", {"1", "2"}, [](P& p) { p.held_out_every = 1; });
  refused(range, "plan.held_out_every", {"5", "4"}, [](P& p) { p.patterns = 4; });
  refused(range, "plan.saturation_share", {"1.5"}, [](P& p) { p.saturation_share = 1.5; });
  refused(range, "plan", {"600000", "524287", "12"}, [](P& p) { p.frames = 600'000; });
  refused(hal::ErrorCode::not_found, "pattern", {"blob", "blobs"}, [](P& p) { p.family = "blob"; });
}
