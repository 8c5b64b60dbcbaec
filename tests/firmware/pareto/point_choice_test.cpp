#include "firmware/operating_points/point_choice.hpp"

#include <doctest/doctest.h>

#include "firmware/operating_points/deadline_choice.hpp"
#include "tests/firmware/pareto/some_sweep.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::some_sweep;

namespace {

constexpr double period_ms = 40.0;

Sweep falling() {
  return some_sweep({{2, 1, 0.44}, {5, 2, 0.3}, {10, 4, 0.2}, {20, 8, 0.1}, {40, 16, 0.05}, {80, 32, 0.045}});
}

}  // namespace

TEST_CASE("the most accurate point whose 99.9th percentile leaves the head-room") {
  const Sweep sweep = falling();
  for (const double deadline_ms : {52.0, 54.0, 60.0, 65.0, 80.0, 200.0}) {
    CAPTURE(deadline_ms);
    const PointChoice choice = choose_points(sweep, 0.3, deadline_ms, period_ms);
    REQUIRE(choice.fits);
    CHECK(choice.age_ms <= deadline_share * deadline_ms);
    const std::size_t chosen = choice.ladder.front();
    CHECK(choice.age_ms == doctest::Approx(predicted_age_ms(sweep.points[chosen].p999_ms, period_ms)));
    if (chosen + 1 == sweep.points.size()) continue;
    CHECK(predicted_age_ms(sweep.points[chosen + 1].p999_ms, period_ms) > deadline_share * deadline_ms);
  }
}

TEST_CASE("the ladder holds faster points only, each by half again, and not many") {
  const Sweep sweep = falling();
  const PointChoice choice = choose_points(sweep, 0.3, 200.0, period_ms);
  REQUIRE(choice.ladder.size() == most_rungs);
  CHECK(choice.ladder == std::vector<std::size_t>{5, 4, 3, 2});
  for (std::size_t r = 1; r < choice.ladder.size(); ++r) {
    CHECK(sweep.points[choice.ladder[r]].p999_ms * rung_speed_up <= sweep.points[choice.ladder[r - 1]].p999_ms);
  }
  CHECK(choice.memory_bytes == 1100);  // of one curve: shared
  const Sweep close = some_sweep({{10, 7.9, 0.2}, {11, 8, 0.19}});
  CHECK(choose_points(close, 0.3, 1000.0, period_ms).ladder == std::vector<std::size_t>{1});
}

TEST_CASE("points of another curve cost memory of their own") {
  const Sweep sweep = some_sweep({{2, 1, 0.44}, {5, 2, 0.3, recon::BasisKind::tv}, {10, 4, 0.2}});
  const PointChoice choice = choose_points(sweep, 0.3, 1000.0, period_ms);
  CHECK(choice.ladder.size() == 3);
  CHECK(choice.memory_bytes == 2200);
  Sweep huge = sweep;
  huge.points[1].table_bytes = most_ladder_bytes + 1;
  CHECK(choose_points(huge, 0.3, 1000.0, period_ms).ladder == std::vector<std::size_t>{2, 0});
}

TEST_CASE("a point that is slower and no better is never chosen, nor stepped to") {
  const Sweep sweep = some_sweep({{2, 1, 0.2}, {5, 2, 0.3}, {10, 4, 0.1}});
  CHECK(choose_points(sweep, 0.3, 1000.0, period_ms).ladder == std::vector<std::size_t>{2, 0});
}

TEST_CASE("the noise level nearest to the board's sigma judges") {
  Sweep sweep = some_sweep({{2, 1, 0.2}, {10, 4, 0.1}});
  sweep.points[0].levels[1].quality.mean.nmse = 0.05;
  CHECK(choose_points(sweep, 0.4, 1000.0, period_ms).ladder.front() == 1);
  const PointChoice noisy = choose_points(sweep, 1.0, 1000.0, period_ms);
  CHECK(noisy.level == 1);
  CHECK(noisy.ladder.front() == 0);
  CHECK(choose_points(sweep, 0.0, 1000.0, period_ms).level == 0);
}

TEST_CASE("a deadline that nothing meets gets an accurate point nearly as young and says so") {
  const Sweep sweep = falling();
  const PointChoice choice = choose_points(sweep, 0.3, 5.0, period_ms);
  CHECK_FALSE(choice.fits);
  CHECK(choice.ladder == std::vector<std::size_t>{3, 2, 1, 0});
  for (const char* value : {"5.00", "6", "48.8"}) CHECK(compueye::test::names(sentence(choice, sweep), value));
}

TEST_CASE("below reach, accuracy chooses among points nearly as fast, and never one like the conventional eye") {
  // The conventional eye has .6: one iteration is a black picture, however fast.
  const Sweep sweep = some_sweep({{1, 0.5, 1.0}, {2, 1, 0.5}, {3, 1.4, 0.3}, {90, 36, 0.1}});
  const PointChoice choice = choose_points(sweep, 0.3, 5.0, period_ms);
  CHECK_FALSE(choice.fits);
  CHECK(choice.ladder == std::vector<std::size_t>{2});
  for (const char* value : {"0.600", "0.300", "3"}) CHECK(compueye::test::names(sentence(choice, sweep), value));
  // Nor is it stepped down to, nor taken where it alone is in time.
  CHECK(choose_points(sweep, 0.3, 1000.0, period_ms).ladder == std::vector<std::size_t>{3, 2});
  CHECK(choose_points(sweep, 0.3, (period_ms + 0.6) / deadline_share, period_ms).ladder.front() == 2);
}

TEST_CASE("where no point is better than the conventional eye there is none to choose, and that is said") {
  const Sweep sweep = some_sweep({{1, 0.5, 1.0}, {2, 1, 0.46}});
  const PointChoice choice = choose_points(sweep, 0.3, 1000.0, period_ms);
  CHECK(choice.ladder.empty());
  CHECK_FALSE(choice.fits);
  CHECK(compueye::test::names(sentence(choice, sweep), "2"));
}

TEST_CASE("no point that is slower than the frames come, whatever the deadline") {
  const Sweep sweep = falling();
  CHECK(choose_points(sweep, 0.3, 1000.0, 10.0).ladder.front() == 3);
  const PointChoice none = choose_points(sweep, 0.3, 1000.0, 0.5);
  CHECK_FALSE(none.keeps_up);
  CHECK_FALSE(none.fits);
  CHECK(none.ladder.front() == 0);
}

TEST_CASE("the sentence names the point, why it, and what comes after it") {
  const Sweep sweep = falling();
  const std::string text = sentence(choose_points(sweep, 0.3, 80.0, period_ms), sweep);
  CAPTURE(text);
  for (const char* part : {"80.0 ms", "admm dct, 40 iterations", "NMSE 0.0500", "17.6 ms", "6 stored points",
                           "steps down to admm dct, 20 iterations, admm dct, 10 iterations", "1.07 KiB"}) {
    CHECK(text.find(part) != std::string::npos);
  }
}

TEST_CASE("no rung whose frames cannot be told from those of another") {
  Sweep sweep = some_sweep({{10, 1, 0.2}, {10, 4, 0.1}});
  sweep.points[0].curve.threads = 2;
  CHECK(choose_points(sweep, 0.3, 1000.0, period_ms).ladder == std::vector<std::size_t>{1});
}

TEST_CASE("a warm start counts with what it made of a scene in which something moves") {
  Sweep sweep = some_sweep({{5, 1, 0.2}, {5, 1.1, 0.01}, {5, 1.2, 0.1}});
  sweep.points[1].curve.motion = Motion::still;
  sweep.points[2].curve.motion = Motion::sprite;
  CHECK(choose_points(sweep, 0.3, 1000.0, period_ms).ladder.front() == 2);
}
