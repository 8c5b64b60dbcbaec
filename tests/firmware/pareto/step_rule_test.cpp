#include <doctest/doctest.h>

#include <vector>

#include "firmware/operating_points/point_ladder.hpp"
#include "tests/hal/units.hpp"

using namespace compueye::firmware;

namespace {

using compueye::test::ms;
using compueye::test::second;

/// Frames every `period`, late on a rung below `fast_enough` while `loaded`.
struct Stream {
  StepRule rule;
  std::int64_t now_ns = 0;
  std::int64_t period_ns = 20 * ms;

  void frame(bool late) { rule.published(rule.rung(), late, now_ns += period_ns); }
  void frames(int count, bool late) {
    for (int i = 0; i < count; ++i) frame(late);
  }
  void run(std::int64_t for_ns, std::size_t fast_enough) {
    for (const std::int64_t end_ns = now_ns + for_ns; now_ns < end_ns;) frame(rule.rung() < fast_enough);
  }
};

}  // namespace

TEST_CASE("three misses in a row step down, two do not") {
  Stream s{StepRule(3)};
  s.frames(50, false);
  s.frames(2, true);
  CHECK(s.rule.rung() == 0);
  s.frame(true);
  CHECK(s.rule.rung() == 1);
  CHECK(s.rule.steps_down() == 1);
  CHECK(s.rule.misses() == 3);
}

TEST_CASE("single misses far apart are forgiven, a fifth of all frames is not") {
  Stream rare{StepRule(2)};
  for (int i = 0; i < 500; ++i) rare.frame(i % 20 == 0);
  CHECK(rare.rule.rung() == 0);
  CHECK(rare.rule.misses() == 25);
  Stream often{StepRule(2)};
  for (int i = 0; i < 100 && often.rule.rung() == 0; ++i) often.frame(i % 3 == 0);
  CHECK(often.rule.rung() == 1);
}

TEST_CASE("a burst steps down once and comes back once") {
  Stream s{StepRule(3)};
  s.run(5 * second, 0);
  s.frames(3, true);
  CHECK(s.rule.rung() == 1);
  s.run(1900 * ms, 0);
  CHECK(s.rule.rung() == 1);
  s.run(200 * ms, 0);
  CHECK(s.rule.rung() == 0);
  s.run(100 * second, 0);
  CHECK(s.rule.steps_down() == 1);
  CHECK(s.rule.steps_up() == 1);
}

TEST_CASE("a load that stays makes fewer and fewer attempts instead of flapping") {
  Stream s{StepRule(2)};
  s.run(600 * second, 1);
  CHECK(s.rule.rung() == 1);
  // Calm of 2, 4, 8, 16, 32 and then 64 s each time.
  CHECK(s.rule.steps_up() <= 14);
  CHECK(s.rule.steps_up() >= 8);
  CHECK(s.rule.steps_down() == s.rule.steps_up() + 1);
  CHECK(s.rule.misses() == 3 * s.rule.steps_down());
}

TEST_CASE("when the load goes, a step up that holds makes the next one quick again") {
  Stream s{StepRule(2)};
  s.run(200 * second, 1);
  REQUIRE(s.rule.rung() == 1);
  s.run(200 * second, 0);
  CHECK(s.rule.rung() == 0);
  const auto up = s.rule.steps_up();
  s.frames(3, true);
  CHECK(s.rule.rung() == 1);
  s.run(2100 * ms, 0);
  CHECK(s.rule.rung() == 0);
  CHECK(s.rule.steps_up() == up + 1);
}

TEST_CASE("it goes as far down as it must, back as far as it can, and never beyond its rungs") {
  Stream s{StepRule(4)};
  s.run(3 * second, 2);
  CHECK(s.rule.rung() == 2);
  s.run(5 * second, 9);
  CHECK(s.rule.rung() == 3);
  s.run(600 * second, 0);
  CHECK(s.rule.rung() == 0);
  Stream alone{StepRule(1)};
  alone.frames(1000, true);
  CHECK(alone.rule.rung() == 0);
  CHECK(alone.rule.steps_down() == 0);
  CHECK(alone.rule.misses() == 1000);
}

TEST_CASE("frames that were solved before a step say nothing about the rung after it") {
  StepRule rule(3);
  std::int64_t now = 0;
  for (int i = 0; i < 3; ++i) rule.published(0, true, now += 10 * ms);
  REQUIRE(rule.rung() == 1);
  for (int i = 0; i < 10; ++i) rule.published(0, true, now += 10 * ms);
  CHECK(rule.rung() == 1);
  CHECK(rule.misses() == 13);
}

TEST_CASE("a slow stream waits for frames, not only for seconds") {
  Stream s{StepRule(2)};
  s.period_ns = second;
  s.frames(3, true);
  REQUIRE(s.rule.rung() == 1);
  s.frames(19, false);
  CHECK(s.rule.rung() == 1);
  s.frame(false);
  CHECK(s.rule.rung() == 0);
}
