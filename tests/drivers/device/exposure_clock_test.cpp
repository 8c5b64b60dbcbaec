
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "drivers/device/stream_extent.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using namespace compueye::device;

namespace {

using compueye::test::ms;
constexpr std::int64_t hour = 3'600'000 * ms;

}  // namespace

TEST_CASE("frames are complete one period after the other, before a time and not at it") {
  ExposureClock clock;
  clock.begin(1000, 10);
  CHECK(clock.exposed_before(0) == 0);
  CHECK(clock.exposed_before(1000) == 0);
  CHECK(clock.exposed_before(1010) == 0);
  CHECK(clock.exposed_before(1011) == 1);
  CHECK(clock.exposed_before(1100) == 9);
  CHECK(clock.exposed_before(1101) == 10);
}

TEST_CASE("the estimate stays within a frame of the truth while the clocks drift apart and the reader dawdles") {
  for (const double drift : {-300e-6, -20e-6, 0.0, 20e-6, 300e-6}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(drift);
      CAPTURE(seed);
      std::mt19937_64 random(seed);
      const std::int64_t start_ns = 5 * ms, period_ns = 10 * ms, latency_ns = 2 * ms;
      const double true_period_ns = static_cast<double>(period_ns) * (1.0 + drift);
      const auto ready_ns = [&](std::uint64_t frame) {
        return start_ns + static_cast<std::int64_t>(static_cast<double>(frame + 1) * true_period_ns);
      };
      ExposureClock clock;
      clock.begin(start_ns, period_ns);
      std::int64_t reader_ns = 0;
      std::uint64_t worst = 0;
      for (std::uint64_t frame = 0; ready_ns(frame) < hour; ++frame) {
        const auto jitter_ns = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(2 * ms));
        const std::int64_t there_ns = ready_ns(frame) + latency_ns + jitter_ns;
        clock.saw_frame(frame, std::max(reader_ns, there_ns), there_ns > reader_ns);
        reader_ns = std::max(reader_ns, there_ns);
        if (random() % 1000 == 0) reader_ns += 2000 * ms;
        const std::uint64_t estimate = clock.exposed_before(ready_ns(frame) + 1);
        if (frame > 500) worst = std::max(worst, std::max(estimate, frame + 1) - std::min(estimate, frame + 1));
      }
      CHECK(worst <= 1);
    }
  }
}

TEST_CASE("a frame number beyond all time does no harm") {
  ExposureClock clock;
  clock.begin(0, ms);
  clock.saw_frame(~std::uint64_t{0}, 5 * ms, true);
  clock.saw_frame(~std::uint64_t{0} / 4, 5 * ms, true);
  CHECK(clock.exposed_before(10 * ms + 1) == 10);
}

TEST_CASE("the extent of a stream: asked, forgotten, unreachable, never begun") {
  protocol::Status before;
  before.boot_count = 3;
  before.frames = 40;
  before.last_t_ns = 12345;
  const auto begun = [&] {
    StreamExtent extent;
    extent.begin(7, before, 1000 * ms, 10 * ms);
    return extent;
  };
  protocol::Status after;
  after.boot_count = 3;
  after.config_id = 7;
  after.frames = 25;
  after.overruns = 2;
  after.last_t_ns = 99999;

  StreamExtent asked = begun();
  CHECK(asked.is_open());
  CHECK(asked.close(after, 1255 * ms).made == 25);
  CHECK_FALSE(asked.is_open());
  CHECK(begun().close(after, 1255 * ms).overrun == 2);

  // START never arrived: the counters are those of the stream before.
  protocol::Status untouched = before;
  untouched.config_id = 7;
  CHECK(begun().close(untouched, 1500 * ms).made == 0);
  protocol::Status other = after;
  other.config_id = 6;
  CHECK(begun().close(other, 1500 * ms).made == 0);

  // Started anew 100 ms ago; seen to be gone before that.
  protocol::Status anew = after;
  anew.boot_count = 4;
  anew.config_id = 0;
  anew.now_ns = 100 * ms;
  CHECK(begun().close(anew, 1255 * ms).made == 15);
  // It did so between the last STATUS and SET_CONFIG: it counts this stream.
  protocol::Status anew_before = after;
  anew_before.boot_count = 4;
  anew_before.now_ns = 300 * ms;
  CHECK(begun().close(anew_before, 1255 * ms).made == 25);
  CHECK_FALSE(begun().close(anew_before, 1255 * ms).estimated);
  // As many frames as the stream before had, which it does not remember.
  anew_before.frames = before.frames;
  anew_before.last_t_ns = before.last_t_ns;
  CHECK(begun().close(anew_before, 1405 * ms).made == 40);
  StreamExtent gone = begun();
  gone.saw_gone(1101 * ms);
  gone.saw_gone(1201 * ms);
  CHECK(gone.close(anew, 1255 * ms).made == 10);

  StreamExtent stopped = begun();
  stopped.saw_stopped(1081 * ms);
  CHECK(stopped.close(anew, 1255 * ms).made == 8);
  StreamExtent stopped_later = begun();
  stopped_later.saw_quiet(1051 * ms);
  stopped_later.saw_stopped(1091 * ms);
  CHECK(stopped_later.close(2000 * ms).made == 9);
  StreamExtent idle = begun();
  idle.saw_quiet(1051 * ms);
  idle.saw_stopped(1091 * ms);
  idle.saw_idle();
  idle.saw_gone(1500 * ms);  // long over
  CHECK(idle.close(2000 * ms).made == 5);

  StreamExtent stopped_then_anew = begun();
  stopped_then_anew.saw_stopped(1061 * ms);
  stopped_then_anew.saw_idle();
  CHECK(stopped_then_anew.close(anew, 1255 * ms).made == 6);

  StreamExtent quiet = begun();
  quiet.saw_quiet(1051 * ms);
  CHECK(quiet.close(2000 * ms).made == 5);
  CHECK(begun().close(1255 * ms).made == 25);
}

TEST_CASE("a count that cannot be is not believed, one that went round is") {
  protocol::Status before, after;
  after.config_id = 1;
  after.last_t_ns = 1;
  StreamExtent extent;
  extent.begin(1, before, 0, 1000);
  after.frames = 0x7000'0000;
  CHECK(extent.close(after, 10'000 * 1000 + 1).made == 10'000);
  const std::int64_t frames = (std::int64_t{1} << 32) + 77;
  extent.begin(1, before, 0, 1000);
  after.frames = 75;
  CHECK(extent.close(after, frames * 1000 + 1).made == static_cast<std::uint64_t>(frames) - 2);
}
