#include <doctest/doctest.h>

#include "drivers/recording/replay_source.hpp"
#include "tests/drivers/recording/film_checks.hpp"
#include "tests/drivers/recording/simulated_recording.hpp"
#include "tests/hal/sample_source_contract.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::recording;
using namespace compueye::recording::tests;
using compueye::hal::tests::check_sample_source_contract;
using compueye::hal::tests::SourceUnderTest;
using compueye::test::TemporaryFolder;

namespace {

SourceUnderTest replayed(const std::filesystem::path& file, ReplayPace pace) {
  SourceUnderTest test;
  test.make = [file, pace](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    return std::move(ReplaySource::open(file, pace, clock).value());
  };
  test.paced = pace == ReplayPace::recorded;
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  return test;
}

}  // namespace

TEST_CASE("a recording keeps the contract of sample sources at both paces") {
  const TemporaryFolder folder;
  record(small_eye(), folder / "eye.rec");
  for (const ReplayPace pace : {ReplayPace::recorded, ReplayPace::fast}) {
    CAPTURE(pace == ReplayPace::fast);
    SourceUnderTest test = replayed(folder / "eye.rec", pace);
    test.frames_per_run = 60;
    check_sample_source_contract(test);
  }
}

TEST_CASE("a recording keeps the contract with the gaps and the missing channel that were recorded") {
  const TemporaryFolder folder;
  auto gaps = small_eye();
  gaps.frame_limit = 80;
  gaps.faults.lost_frames = {5, 6, 7};
  record(gaps, folder / "gaps.rec");
  SourceUnderTest with_gaps = replayed(folder / "gaps.rec", ReplayPace::recorded);
  with_gaps.lose_frames = [](hal::SampleSource&, int) {};
  with_gaps.frames_per_run = 77;
  check_sample_source_contract(with_gaps);

  auto missing = small_eye();
  missing.faults.invalid_channels = {{eye_side * eye_side / 2, 3}};
  record(missing, folder / "missing.rec");
  SourceUnderTest with_missing = replayed(folder / "missing.rec", ReplayPace::fast);
  with_missing.lose_channel = [](hal::SampleSource&, int) {};
  check_sample_source_contract(with_missing);
}

TEST_CASE("a recording keeps the contract in real time") {
  const TemporaryFolder folder;
  record(small_eye(1000.0), folder / "eye.rec");
  SourceUnderTest test = replayed(folder / "eye.rec", ReplayPace::recorded);
  test.make_clock = [] { return std::make_unique<hal::MonotonicClock>(); };
  test.paced = false;
  check_sample_source_contract(test);
}

TEST_CASE("a replay is the recorded run: samples, numbers, times, flags and account") {
  const TemporaryFolder folder;
  auto settings = small_eye();
  settings.faults.lost_frames = {0, 11, 12, 59};
  settings.faults.invalid_channels = {{3, 20}};
  const hal::FrameAccount lived = record(settings, folder / "eye.rec");
  for (const ReplayPace pace : {ReplayPace::recorded, ReplayPace::fast}) {
    hal::VirtualClock live_clock(1'000'000'000), clock(77);
    auto eye = sim::SimulatedEye::create(settings, live_clock).value();
    auto replay = ReplaySource::open(folder / "eye.rec", pace, clock).value();
    CHECK(replay->describe().backend == "replay");
    CHECK(replay->describe().serial == eye->describe().serial);
    CHECK(replay->recording().header().source.backend == "sim");
    REQUIRE(eye->start());
    REQUIRE(replay->start());
    int frames = 0;
    while (const auto live = eye->read(live_clock.now_ns() + 1'000'000'000)) {
      FilmFrame want{{live->codes.begin(), live->codes.end()},
                     {live->valid.begin(), live->valid.end()},
                     *live,
                     live_clock.now_ns() - 1'000'000'000,
                     {},
                     0};
      const auto again = replay->read(clock.now_ns() + 1'000'000'000);
      REQUIRE(again);
      REQUIRE(same({*again, want.arrival_ns}, want));
      if (pace == ReplayPace::recorded) CHECK(clock.now_ns() - 77 == want.arrival_ns);
      CHECK(replay->account().dropped == eye->account().dropped);
      CHECK(replay->account().delivered == eye->account().delivered);
      ++frames;
    }
    CHECK(frames == 56);
    if (pace == ReplayPace::fast) CHECK(clock.now_ns() == 77);
    CHECK_FALSE(replay->read(clock.now_ns()));
    CHECK(replay->account().produced == lived.produced);
    CHECK(replay->account().dropped == lived.dropped);
    CHECK(replay->recording().end()->ending == Ending::end_of_stream);
  }
}

TEST_CASE("a damaged recording keeps the contract: what is lost in it is a counted gap") {
  const TemporaryFolder folder;
  record(small_eye(), folder / "eye.rec");
  std::string bytes = compueye::test::bytes_of(folder / "eye.rec");
  const std::size_t frame = frame_block_bytes(eye_side * eye_side, 12);
  const std::size_t first = bytes.size() - end_block_bytes - 60 * frame;
  for (const std::size_t k : {5U, 6U, 7U}) bytes[first + k * frame + 90] ^= 1;
  SourceUnderTest test = replayed(folder.file("damaged.rec", bytes), ReplayPace::fast);
  test.lose_frames = [](hal::SampleSource&, int) {};
  test.frames_per_run = 57;
  check_sample_source_contract(test);
}
