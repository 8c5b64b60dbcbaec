#include "hal/clock.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <thread>
#include <vector>

using namespace compueye::hal;

TEST_CASE("virtual time passes only when somebody sleeps or advances it") {
  VirtualClock clock(100);
  CHECK(clock.now_ns() == 100);
  CHECK(clock.now_ns() == 100);
  clock.advance(50);
  CHECK(clock.now_ns() == 150);
  clock.sleep_until_ns(1'000'000'000'000);
  CHECK(clock.now_ns() == 1'000'000'000'000);
}

TEST_CASE("a sleep into the past returns at once and never turns a clock back") {
  VirtualClock clock(1000);
  clock.sleep_until_ns(10);
  CHECK(clock.now_ns() == 1000);
  clock.sleep_until_ns(std::numeric_limits<std::int64_t>::min());
  CHECK(clock.now_ns() == 1000);

  MonotonicClock real;
  const std::int64_t before = real.now_ns();
  real.sleep_until_ns(before - 1'000'000'000);
  CHECK(real.now_ns() >= before);
}

TEST_CASE("the monotonic clock sleeps until its time") {
  MonotonicClock clock;
  const std::int64_t until = clock.now_ns() + 2'000'000;
  clock.sleep_until_ns(until);
  CHECK(clock.now_ns() >= until);
}

TEST_CASE("threads that share a virtual clock see it move forwards only") {
  VirtualClock clock;
  std::vector<std::thread> threads;
  std::vector<int> steps_back(3, 0);
  for (std::size_t t = 0; t < steps_back.size(); ++t) {
    threads.emplace_back([&clock, &steps_back, t] {
      std::int64_t last = clock.now_ns();
      for (int i = 0; i < 1000; ++i) {
        clock.sleep_until_ns(last + static_cast<std::int64_t>(t));
        clock.advance(1);
        const std::int64_t now = clock.now_ns();
        if (now <= last) ++steps_back[t];
        last = now;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(steps_back == std::vector<int>{0, 0, 0});
  CHECK(clock.now_ns() >= 3000);
}
