#include "firmware/pipeline/device_time.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>

#include "tests/hal/units.hpp"

using namespace compueye::firmware;
using compueye::hal::SampleBlock;

namespace {

using compueye::test::ms;
constexpr std::int64_t us = 1000;

SampleBlock at(std::int64_t t_ns, bool time_ok = true) {
  SampleBlock block;
  block.t_ns = t_ns;
  block.flags.time_ok = time_ok;
  return block;
}

}  // namespace

TEST_CASE("on the host's own clock the time stamp is the answer") {
  DeviceTime time(DeviceClock::host, 100.0);
  CHECK(time.exposure_start_ns(at(5 * ms), 999 * ms) == 5 * ms);
  CHECK(time.exposure_start_ns(at(-5 * ms), 999 * ms) == -5 * ms);
}

TEST_CASE("without a trusted time stamp the exposure began one period before arrival") {
  for (const DeviceClock relation : {DeviceClock::host, DeviceClock::free_running}) {
    DeviceTime time(relation, 100.0);
    CHECK(time.exposure_start_ns(at(123, false), 50 * ms) == 40 * ms);
    DeviceTime no_rate(relation, 0.0);
    CHECK(no_rate.exposure_start_ns(at(123, false), 50 * ms) == 50 * ms);
  }
}

TEST_CASE("the offset of a free-running clock is found through jitter and drift") {
  // True exposure starts are known here; frames take one period plus 50 us at best, up to 4 ms more at worst.
  for (const double drift : {0.0, 100e-6, -100e-6}) {
    CAPTURE(drift);
    DeviceTime time(DeviceClock::free_running, 100.0);
    std::mt19937 random(7);
    std::exponential_distribution<double> jitter_ms(2.0);
    std::int64_t worst_early = 0;
    std::int64_t worst_late = 0;
    for (int frame = 0; frame < 5000; ++frame) {
      const std::int64_t truth = 77 * ms + frame * 10 * ms;
      const auto device =
          static_cast<std::int64_t>(static_cast<double>(frame * 10 * ms) * (1.0 + drift)) - 900'000 * ms;
      const auto jitter = static_cast<std::int64_t>(1e6 * std::min(jitter_ms(random), 4.0));
      const std::int64_t found = time.exposure_start_ns(at(device), truth + 10 * ms + 50 * us + jitter);
      if (frame < 100) continue;
      worst_early = std::min(worst_early, found - truth);
      worst_late = std::max(worst_late, found - truth);
    }
    // 512 frames of 10 ms drift apart by 0.51 ms at most; the rest is the best frame's own 50 us and its jitter.
    CHECK(worst_early >= -600 * us);
    CHECK(worst_late <= 250 * us);
  }
}

TEST_CASE("a device clock that was set back is learnt anew") {
  DeviceTime time(DeviceClock::free_running, 100.0);
  for (int frame = 0; frame < 20; ++frame) {
    static_cast<void>(time.exposure_start_ns(at(5000 * ms + frame * 10 * ms), frame * 10 * ms));
  }
  CHECK(time.exposure_start_ns(at(0), 200 * ms) == 190 * ms);
}

TEST_CASE("a device clock that was set back across a gap dates no frame early") {
  // The frame behind the gap says that its time is doubtful; those after it are trusted, and later than any before.
  for (const std::int64_t back : {100 * ms, 200 * ms, 259 * ms}) {
    DeviceTime time(DeviceClock::free_running, 100.0);
    for (int frame = 0; frame < 2000; ++frame) {
      if (frame >= 1000 && frame < 1025) continue;
      const std::int64_t truth = frame * 10 * ms;
      const SampleBlock block = at(truth + 5000 * ms - (frame >= 1000 ? back : 0), frame != 1025);
      CHECK(time.exposure_start_ns(block, truth + 10 * ms) == truth);
    }
  }
}
