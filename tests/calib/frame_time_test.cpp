#include "calib/session/frame_time.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>

#include "tests/hal/units.hpp"

using namespace compueye;

namespace {

using compueye::test::ms;
using compueye::test::second;

struct Span {
  std::int64_t least_ns = second, most_ns = -second;
};

/// How late frames seem to begin, over an hour but for its first second: 100 a second, whose way takes 3 ms and up to 7
/// more, of a device whose clock is fast by `ppm`.
Span lateness(int ppm, bool time_ok = true) {
  calib::FrameTime time;
  Span seen;
  for (std::int64_t frame = 0; frame < 360'000; ++frame) {
    const std::int64_t begun_ns = 5 * second + frame * 10 * ms;
    const std::int64_t device_ns = begun_ns + frame * 10 * ppm - 1000 * second;
    const std::int64_t way_ns = 3 * ms + frame * 7919 % 7000 * 1000;
    const std::int64_t late_ns = time.begun_ns(device_ns, time_ok, begun_ns + way_ns) - begun_ns;
    if (frame < 100) continue;
    seen.least_ns = std::min(seen.least_ns, late_ns);
    seen.most_ns = std::max(seen.most_ns, late_ns);
  }
  return seen;
}

}  // namespace

TEST_CASE("a frame's beginning is known to within its least way, however far two clocks drift apart in an hour") {
  for (const int ppm : {0, 50, -50, 2000, -2000}) {
    CAPTURE(ppm);
    const Span seen = lateness(ppm);
    // Never so late that a frame of before could pass; early by what a slow clock loses in two stretches.
    const std::int64_t lost_ns = 2 * calib::FrameTime::stretch_ns / 1'000'000 * std::max(-ppm, 0);
    CHECK(seen.least_ns >= 3 * ms - lost_ns);
    CHECK(seen.most_ns <= 4 * ms);
  }
}

TEST_CASE("a frame without a time counts from when it came") {
  const Span seen = lateness(0, false);
  CHECK(seen.least_ns == 3 * ms);
  CHECK(seen.most_ns == 10 * ms - 1000);
}
