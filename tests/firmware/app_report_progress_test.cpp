#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>

#include "firmware/app/progress_reporter.hpp"
#include "hal/clock.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

using compueye::test::second;

struct Screen {
  std::string text;
  ProgressReporter::Write writer() {
    return [this](std::string_view piece) { text += piece; };
  }
  [[nodiscard]] auto count(char c) const { return std::count(text.begin(), text.end(), c); }
  [[nodiscard]] bool shows(std::string_view piece) const { return text.find(piece) != std::string::npos; }
};

ProgressStyle terminal(std::size_t columns = 80) {
  ProgressStyle style;
  style.terminal = true;
  style.columns = columns;
  return style;
}

}  // namespace

TEST_CASE("plain progress comes in rare lines with the time left") {
  hal::VirtualClock clock;
  Screen screen;
  ProgressReporter progress(clock, {}, screen.writer());
  for (int step = 0; step <= 100; ++step) {
    progress.update("factor", step, 100);
    if (step < 100) clock.advance(second / 2);
  }
  CHECK(screen.count('\n') == 9);
  CHECK(screen.shows("factor:  10 %, 45 s left\n"));
  CHECK(screen.shows("factor:  90 %, 5.0 s left\n"));
  progress.finish();
  progress.finish();
  CHECK(screen.text.ends_with("factor: 100 %, 50 s\n"));
  CHECK(screen.count('\n') == 10);
  CHECK(screen.count('\r') == 0);
}

TEST_CASE("an estimate is a line of its own at once, in a log and on a terminal, and the work's own progress follows") {
  for (const ProgressStyle& style : {ProgressStyle{}, terminal()}) {
    hal::VirtualClock clock;
    Screen screen;
    ProgressReporter progress(clock, style, screen.writer());
    progress.expect("set-up", 251.0);
    CHECK(screen.text.starts_with("set-up: "));
    CHECK(screen.shows("4 min 11 s"));
    CHECK(screen.shows("estimate"));
    CHECK(screen.text.ends_with("\n"));
    CHECK(screen.count('\n') == 1);
    progress.update("inverse", 0.0, 1.0);
    clock.advance(20 * second);
    progress.update("inverse", 0.2, 1.0);
    CHECK(screen.shows("1 min 20 s left"));
  }
}

TEST_CASE("plain progress of a slow task still speaks up") {
  hal::VirtualClock clock;
  Screen screen;
  ProgressReporter progress(clock, {}, screen.writer());
  for (int tick = 0; tick < 60; ++tick) {
    progress.update("slow", tick, 100000);
    clock.advance(second);
  }
  CHECK(screen.count('\n') == 5);
}

TEST_CASE("a short stage is silent in a log, however often it reports") {
  hal::VirtualClock clock;
  Screen screen;
  {
    ProgressReporter progress(clock, {}, screen.writer());
    for (int step = 0; step <= 1000; ++step) {
      progress.update(step % 2 == 0 ? "a" : "b", step, 1000);
      clock.advance(1000);
    }
    progress.finish();
  }
  CHECK(screen.text.empty());
}

TEST_CASE("a terminal line is redrawn at most ten times a second and cleaned up") {
  hal::VirtualClock clock;
  Screen screen;
  ProgressReporter progress(clock, terminal(), screen.writer());
  for (int step = 0; step < 2000; ++step) {
    progress.update("factor", step, 2000);
    clock.advance(second / 1000);
  }
  CHECK(screen.count('\r') == 20);
  CHECK(screen.count('\n') == 0);
  CHECK(screen.shows("[####################....................]  50 %, 1.0 s left\x1b[K"));
  progress.update("factor", 2000, 2000);
  CHECK(screen.shows("100 %\x1b[K"));
  progress.finish();
  CHECK(screen.text.ends_with("\r\x1b[Kfactor: 100 %, 2.0 s\n"));
}

TEST_CASE("a terminal line never reaches the last column") {
  for (const std::size_t columns : {1UL, 20UL, 27UL, 40UL, 80UL, 300UL}) {
    CAPTURE(columns);
    hal::VirtualClock clock;
    Screen screen;
    ProgressReporter progress(clock, terminal(columns), screen.writer());
    progress.update("a stage with a rather long name", 1, 3);
    clock.advance(second);
    screen.text.clear();
    progress.update("a stage with a rather long name", 2, 3);
    const std::size_t end = screen.text.find('\x1b');
    REQUIRE(end != std::string::npos);
    CHECK(end - 1 < std::max<std::size_t>(columns, 20));
  }
}

TEST_CASE("an abandoned terminal line is ended, so that the error has its own") {
  hal::VirtualClock clock;
  Screen screen;
  {
    ProgressReporter progress(clock, terminal(), screen.writer());
    progress.update("factor", 1, 10);
  }
  CHECK(screen.text.ends_with("\x1b[K\n"));
}

TEST_CASE("a new stage ends the one before and starts its own clock") {
  hal::VirtualClock clock;
  Screen screen;
  ProgressReporter progress(clock, {}, screen.writer());
  progress.update("response", 0, 10);
  clock.advance(100 * second);
  progress.update("factor", 0, 10);
  CHECK(screen.text == "response: 0 %, 1 min 40 s\n");
  clock.advance(2 * second);
  progress.update("factor", 5, 10);
  CHECK(screen.text.ends_with("factor:  50 %, 2.0 s left\n"));
}

TEST_CASE("odd amounts of work are told as unknown or clipped") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double inf = std::numeric_limits<double>::infinity();
  struct Case {
    double done, total;
    std::string_view shown;
  };
  for (const Case& c :
       {Case{1, 0, "x: 11 s\n"}, Case{1, -5, "x: 11 s\n"}, Case{1, inf, "x: 11 s\n"}, Case{1, nan, "x: 11 s\n"},
        Case{nan, 10, "x: 11 s\n"}, Case{-3, 10, "x:   0 %\n"}, Case{inf, 10, ""}, Case{20, 10, ""}}) {
    CAPTURE(c.done);
    CAPTURE(c.total);
    hal::VirtualClock clock;
    Screen screen;
    ProgressReporter progress(clock, {}, screen.writer());
    progress.update("x", 0, 10);
    clock.advance(11 * second);
    progress.update("x", c.done, c.total);
    CHECK(screen.text == c.shown);
  }
}

TEST_CASE("a stage name cannot break the line") {
  hal::VirtualClock clock;
  Screen screen;
  ProgressReporter progress(clock, {}, screen.writer());
  progress.update("a\nb\x1b[2J", 1, 10);
  clock.advance(20 * second);
  progress.update("a\nb\x1b[2J", 2, 10);
  CHECK(screen.text == "a\\nb\\x1b[2J:  20 %, 1 min 20 s left\n");
}
