#include "firmware/operating_points/deadline_choice.hpp"

#include <doctest/doctest.h>

#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;

namespace {

constexpr SolveTime time_of_machine{2e6, 1e6};  // 2 ms and 1 ms an iteration

}  // namespace

TEST_CASE("as many iterations as the deadline leaves room for, with head-room, and not one more") {
  for (const double deadline_ms : {88.0, 100.0, 120.0, 140.0, 155.0}) {
    const DeadlineChoice choice = choose_iterations(deadline_ms, 62.0, time_of_machine, 60);
    CAPTURE(deadline_ms);
    REQUIRE(choice.fits);
    CHECK(choice.age_ms <= deadline_share * deadline_ms);
    if (choice.iterations == 60) continue;
    const DeadlineChoice with_one_more = choose_iterations(1e9, 62.0, time_of_machine, choice.iterations + 1);
    CHECK(with_one_more.age_ms > deadline_share * deadline_ms);
  }
}

TEST_CASE("the deadlines it names are the ones that it keeps") {
  const DeadlineChoice choice = choose_iterations(90.0, 62.0, time_of_machine, 60);
  CHECK(choose_iterations(choice.for_most_ms * 1.0001, 62.0, time_of_machine, 60).iterations == 60);
  CHECK(choose_iterations(choice.for_most_ms * 0.9999, 62.0, time_of_machine, 60).iterations < 60);
  CHECK(choose_iterations(choice.least_ms * 1.0001, 62.0, time_of_machine, 60).fits);
  CHECK_FALSE(choose_iterations(choice.least_ms * 0.9999, 62.0, time_of_machine, 60).fits);
}

TEST_CASE("a deadline that one exposure passes gets iterations worth a picture that is hardly older, and says so") {
  const DeadlineChoice choice = choose_iterations(5.0, 10.0, time_of_machine, 60);
  CHECK_FALSE(choice.fits);
  CHECK(choice.iterations == 6);
  CHECK(choice.age_ms <= nearly_as_fast * 15.0);  // that of three
  CHECK(choose_iterations(5.0, 4.9, time_of_machine, 60).iterations == least_iterations);
  for (const char* value : {"5.00", "6", "60"}) CHECK(test::names(choice.sentence(), value));
  CHECK(choose_iterations(5.0, 10.0, time_of_machine, 2).iterations == 2);
}

TEST_CASE("no more iterations than keep up with the frames, whatever the deadline") {
  const DeadlineChoice choice = choose_iterations(1000.0, 10.0, time_of_machine, 60);
  CHECK(choice.fits);
  CHECK(choice.by_rate);
  CHECK(choice.iterations == 8);
  CHECK_FALSE(choose_iterations(20.0, 10.0, time_of_machine, 60).by_rate);
}

TEST_CASE("the time of a solve is found as a line in the number of iterations") {
  const auto exact = [](int iterations) -> hal::Result<std::int64_t> { return 2'000'000 + 1'000'000LL * iterations; };
  const auto time = measure_solve_time(exact, 80);
  REQUIRE(time.has_value());
  CHECK(time->of(80) == doctest::Approx(82e6));
  CHECK(time->of(7) == doctest::Approx(9e6));
}

TEST_CASE("trials that were disturbed still give a time that grows with the iterations and is never negative") {
  for (const bool slow_first : {true, false}) {
    const auto disturbed = [&](int iterations) -> hal::Result<std::int64_t> {
      return (iterations == 80) == slow_first ? 900'000'000 : 1'000;
    };
    const auto time = measure_solve_time(disturbed, 80);
    REQUIRE(time.has_value());
    CHECK(time->per_iteration_ns > 0.0);
    CHECK(time->fixed_ns >= 0.0);
  }
}

TEST_CASE("an error of a trial is passed on") {
  const auto broken = [](int) -> hal::Result<std::int64_t> { return hal::fail(hal::ErrorCode::io, "x", "y"); };
  CHECK_FALSE(measure_solve_time(broken, 10).has_value());
}
