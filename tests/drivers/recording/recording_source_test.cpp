#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <thread>

#include "tests/drivers/recording/film_checks.hpp"
#include "tests/drivers/recording/simulated_recording.hpp"
#include "tests/hal/sample_source_contract.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::recording;
using namespace compueye::recording::tests;
using compueye::test::TemporaryFolder;

namespace {

/// An eye and its recording as one source.
class RecordedEye final : public hal::SampleSource {
 public:
  RecordedEye(RecordingSettings settings, const sim::SimulatedEyeSettings& eye, hal::Clock& clock)
      : eye_(sim::SimulatedEye::create(eye, clock).value()),
        tee_(RecordingSource::create(std::move(settings), *eye_, clock).value()) {}

 private:
  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return tee_->describe(); }
  hal::Result<void> do_start() override { return tee_->start(); }
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override { return tee_->read(deadline_ns); }
  void do_stop() noexcept override { tee_->stop(); }
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override { return tee_->account(); }
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override { return tee_->counters(); }

  std::unique_ptr<sim::SimulatedEye> eye_;
  std::unique_ptr<RecordingSource> tee_;
};

}  // namespace

TEST_CASE("a source that is recorded keeps the contract, each run in a file of its own") {
  const TemporaryFolder folder;
  int made = 0;
  hal::tests::SourceUnderTest test;
  test.make = [&](hal::Clock& clock) -> std::unique_ptr<hal::SampleSource> {
    RecordingSettings settings;
    settings.path = folder / (std::to_string(made++) + ".rec");
    return std::make_unique<RecordedEye>(settings, small_eye(), clock);
  };
  test.frames_per_run = 60;
  test.heap_calls = [] { return compueye::tests::heap_use_of_this_thread().calls(); };
  hal::tests::check_sample_source_contract(test);
  CHECK(std::filesystem::exists(folder / "3-3.rec"));  // the third run of the part that starts again
  std::size_t readable = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    auto reader = RecordingReader::open(entry.path());
    REQUIRE(reader);
    while (reader->next()) {
    }
    readable += reader->end() && reader->damage().torn_bytes == 0 ? 1U : 0U;
  }
  CHECK(readable == folder.entries());
}

TEST_CASE("a file that does not keep up costs frames of the recording, each counted, and none of the reader") {
  // A pipe that nobody empties is as slow as a disk can be.
  const TemporaryFolder folder;
  const auto path = folder / "slow";
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  const int pipe = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  REQUIRE(pipe >= 0);
  hal::VirtualClock clock;
  auto eye = sim::SimulatedEye::create(small_eye(), clock).value();
  RecordingSettings settings;
  settings.path = path;
  settings.most_waiting_bytes = 0;
  auto tee = RecordingSource::create(settings, *eye, clock).value();
  REQUIRE(tee->start());
  ::fcntl(pipe, F_SETPIPE_SZ, 4096);
  int delivered = 0;
  while (tee->read(clock.now_ns() + 1'000'000'000)) ++delivered;
  CHECK(delivered == 60);
  CHECK(tee->unrecorded() > 0);
  Bytes bytes;
  ::fcntl(pipe, F_SETFL, 0);
  std::thread drain([&] {
    std::array<std::byte, 4096> piece;
    for (ssize_t got = 0; (got = ::read(pipe, piece.data(), piece.size())) > 0;) {
      bytes.insert(bytes.end(), piece.begin(), piece.begin() + got);
    }
  });
  tee->stop();
  drain.join();
  ::close(pipe);
  CHECK_FALSE(tee->error().has_value());
  CHECK(tee->recorded() + tee->unrecorded() == 60);
  auto reader = reader_of(std::move(bytes));
  REQUIRE(reader);
  while (const auto frame = reader->next()) {
    // Each tells of those before it, and a torn recording has nothing else.
    CHECK(frame->block.frame + 1 == reader->frames() + reader->unrecorded());
  }
  CHECK(reader->frames() == tee->recorded());
  CHECK(reader->unrecorded() == tee->unrecorded());
  CHECK(reader->account().balanced());
  CHECK(reader->account().produced == 60);
  CHECK(reader->account().drops(hal::DropReason::transport_gap) == tee->unrecorded());
}

TEST_CASE("a disk that fails is told, and the frames go on") {
  hal::VirtualClock clock;
  auto eye = sim::SimulatedEye::create(small_eye(), clock).value();
  const TemporaryFolder folder;
  const auto path = folder / "broken";
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  const int pipe = ::open(path.c_str(), O_RDONLY | O_NONBLOCK);
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  RecordingSettings settings;
  settings.path = path;
  settings.when_full = WhenFull::wait;
  auto tee = RecordingSource::create(settings, *eye, clock).value();
  REQUIRE(tee->start());
  ::close(pipe);
  int delivered = 0;
  while (tee->read(clock.now_ns() + 1'000'000'000)) ++delivered;
  tee->stop();
  std::signal(SIGPIPE, handler);
  CHECK(delivered == 60);
  CHECK(tee->failed());
  CHECK(tee->unrecorded() == 60);
  REQUIRE(tee->error().has_value());
  CHECK(tee->error()->place == path.string());
}

TEST_CASE("a recording that cannot be begun leaves the source stopped") {
  hal::VirtualClock clock;
  auto eye = sim::SimulatedEye::create(small_eye(), clock).value();
  const TemporaryFolder folder;
  RecordingSettings settings;
  settings.path = folder.file("there.rec", "already");
  auto tee = RecordingSource::create(settings, *eye, clock).value();
  const auto refused = tee->start();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().place == settings.path);
  CHECK_FALSE(tee->started());
  CHECK_FALSE(eye->started());
}
