#include "firmware/supervisor/supervisor.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "firmware/supervisor/restart_delay.hpp"
#include "tests/firmware/supervisor/scripted_run.hpp"

namespace {

using namespace compueye::firmware;
using compueye::test::HeardManager;
using compueye::test::ms;
using compueye::test::ScriptedRun;
using compueye::test::second;
using Words = std::vector<std::string>;

/// A supervisor that looks every 100 ms of the script's time.
struct Rig {
  explicit Rig(bool all = true, std::int64_t watchdog_ns = 10 * second)
      : manager(watchdog_ns),
        supervisor(
            {}, manager, [this](int p, const std::string& s) { said.emplace_back(p, s); }, all) {}
  void look() { supervisor.look(run.now_ns, run.counters, "25.0/s"); }
  void live(int frames) {
    for (int i = 0; i < frames; ++i) {
      run.frames(1);
      if (i % 10 == 9) look();
    }
  }
  void wait(std::int64_t ns) {
    for (const std::int64_t end = run.now_ns + ns; run.now_ns < end;) {
      run.now_ns += 100 * ms;
      look();
    }
  }

  ScriptedRun run;
  HeardManager manager;
  std::vector<std::pair<int, std::string>> said;
  Supervisor supervisor;
};

TEST_CASE("ready is told with the first picture and not before, and the start is extended until then") {
  Rig rig;
  rig.wait(5 * second);
  for (const std::string& word : rig.manager.heard) CHECK((word == "starting" || word == "alive"));
  CHECK(std::count(rig.manager.heard.begin(), rig.manager.heard.end(), "starting") == 5);
  rig.live(10);
  CHECK(std::count(rig.manager.heard.begin(), rig.manager.heard.end(), "ready") == 1);
  rig.live(1000);
  CHECK(std::count(rig.manager.heard.begin(), rig.manager.heard.end(), "ready") == 1);
  CHECK(rig.manager.last_status == "picture live; 25.0/s");
}

TEST_CASE("the watchdog is fed four times in its time while pictures come and while an eye is looked for") {
  Rig rig;
  rig.live(10);
  rig.manager.fed = 0;
  rig.live(2000);
  CHECK(rig.manager.fed == 8);
  rig.run.counters.recovering = true;
  rig.wait(20 * second);
  CHECK(rig.manager.fed == 16);
}

TEST_CASE("a stuck sink ends the feeding, asks for a restart once and is named gravely") {
  Rig rig(false);
  rig.live(100);
  rig.run.stage(Stage::publish).working = true;
  rig.wait(10 * second);
  const int fed = rig.manager.fed;
  CHECK(rig.said.empty());
  rig.wait(5 * second);
  CHECK(rig.manager.fed == fed);
  CHECK(std::count(rig.manager.heard.begin(), rig.manager.heard.end(), "restart") == 1);
  REQUIRE(rig.said.size() == 1);
  CHECK(rig.said[0].first == 2);
  CHECK(rig.said[0].second.find("publish is stuck for 10.1 s") != std::string::npos);
  // It came back before anybody restarted it.
  rig.live(1000);
  CHECK(rig.manager.fed > fed);
}

TEST_CASE("changes are said once, graver ones at once and others at most every five seconds") {
  Rig rig;
  rig.live(100);
  REQUIRE(rig.said.size() == 1);
  CHECK(rig.said[0] == std::make_pair(6, std::string("picture live")));
  rig.wait(second);
  REQUIRE(rig.said.size() == 2);
  CHECK(rig.said[1].first == 5);
  rig.wait(2 * second);
  REQUIRE(rig.said.size() == 3);
  CHECK(rig.said[2].second.find("picture blank") == 0);
  // A loose plug: a picture now and then.
  for (int i = 0; i < 100; ++i) {
    rig.live(10);
    rig.wait(500 * ms);
  }
  // Two in five seconds, and not the two hundred that there were.
  CHECK(rig.said.size() <= 3 + 2 * 13);
  rig.live(600);
  CHECK(rig.said.back().second == "picture live");
}

TEST_CASE("time is counted by state, and interruptions with it") {
  Rig rig;
  rig.live(1000);
  rig.wait(4 * second);
  rig.live(1000);
  const auto& s = rig.supervisor;
  CHECK(s.spent_ns(PictureState::live) == doctest::Approx(20.0 * second).epsilon(0.03));
  CHECK(s.spent_ns(PictureState::held) == doctest::Approx(1.7 * second).epsilon(0.1));
  CHECK(s.spent_ns(PictureState::blank) == doctest::Approx(2.0 * second).epsilon(0.1));
  CHECK(s.interruptions() == 1);
  CHECK(s.longest_gap_ns() == doctest::Approx(4.0 * second).epsilon(0.05));
}

TEST_CASE("nothing is told after the end") {
  Rig rig;
  rig.live(100);
  rig.supervisor.stop();
  rig.supervisor.stop();
  const Words before = rig.manager.heard;
  CHECK(before.back() == "stopping");
  rig.wait(60 * second);
  CHECK(rig.manager.heard == before);
}

TEST_CASE("without a watchdog nobody is fed, and the rest is told all the same") {
  Rig rig(true, 0);
  rig.live(2000);
  CHECK(rig.manager.fed == 0);
  CHECK(rig.manager.heard.front() == "ready");
}

TEST_CASE("a service that fails again and again waits longer each time, and never longer than half a minute") {
  std::vector<std::int64_t> waits;
  for (std::uint64_t n = 0; n < 9; ++n) waits.push_back(restart_delay_ns(n) / second);
  CHECK(waits == std::vector<std::int64_t>{0, 1, 2, 4, 8, 16, 30, 30, 30});
  CHECK(restart_delay_ns(~std::uint64_t{0}) == 30 * second);
}

TEST_CASE("a count of failures is read back, and what is no count is none") {
  CHECK(failures_in(failures_text(17)) == 17);
  for (const char* text : {"", "17", "-1\n", "17\n\n", "1e3\n", "99999999999999999999999\n", "\n"}) {
    CAPTURE(text);
    CHECK(failures_in(text) == 0);
  }
}

}  // namespace
