// What of a recording is on the disk, and when; and what is left of one that failed.

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string>
#include <thread>

#include "drivers/recording/recording_reader.hpp"
#include "drivers/recording/recording_source.hpp"
#include "tests/drivers/recording/film_checks.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/hal/no_threads.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::recording;
using namespace compueye::recording::tests;
using compueye::test::bytes_of;
using compueye::test::check_error;
using compueye::test::NoThreads;
using compueye::test::TemporaryFolder;

namespace {

std::atomic<int> data_flushes{0}, file_flushes{0}, folder_flushes{0};

}  // namespace

// In the place of libc's, which only pass the call on: what is asked of the disk is counted.
extern "C" int fdatasync(int fd) {
  ++data_flushes;
  return static_cast<int>(::syscall(SYS_fdatasync, fd));
}

extern "C" int fsync(int fd) {
  struct stat status {};
  ++(::fstat(fd, &status) == 0 && S_ISDIR(status.st_mode) ? folder_flushes : file_flushes);
  return static_cast<int>(::syscall(SYS_fsync, fd));
}

namespace {

/// A hundred frames a second until it is told to fall silent.
class Eye final : public hal::SampleSource {
 public:
  explicit Eye(hal::Clock& clock) : description_(header_of(3, 12).source), clock_(clock) {}
  bool silent = false, interrupted = false;
  std::int32_t first_code = 1;

 private:
  [[nodiscard]] const hal::SourceDescription& do_describe() const noexcept override { return description_; }
  hal::Result<void> do_start() override {
    account_ = {};
    return {};
  }
  hal::Result<hal::SampleBlock> do_read(std::int64_t deadline_ns) override {
    if (silent) {
      clock_.sleep_until_ns(deadline_ns);
      return hal::timed_out();
    }
    if (interrupted) return hal::fail(hal::ErrorCode::interrupted, "eye", "asked to stop");
    clock_.sleep_until_ns(clock_.now_ns() + 10'000'000);
    codes_[0] = first_code;
    hal::SampleBlock block;
    block.codes = codes_;
    block.valid = valid_;
    block.bits = 12;
    block.frame = account_.produced++;
    ++account_.delivered;
    return block;
  }
  void do_stop() noexcept override {}
  [[nodiscard]] hal::FrameAccount do_account() const noexcept override { return account_; }
  [[nodiscard]] bool do_recovering() const noexcept override { return silent; }
  [[nodiscard]] std::uint64_t do_faults() const noexcept override { return hal::faults_in(do_counters()); }
  [[nodiscard]] std::vector<hal::Counter> do_counters() const override {
    return {{"silence", "no frame", 3}, {"restart", "begun anew", 2, false}};
  }

  hal::SourceDescription description_;
  hal::Clock& clock_;
  hal::FrameAccount account_;
  std::vector<std::int32_t> codes_{0, 2, 3};
  std::vector<std::uint8_t> valid_{1, 1, 1};
};

/// Until the writer's thread, which nothing here drives, has come to it.
template <class Done>
bool comes_true(Done done) {
  for (int k = 0; k < 20'000; ++k) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

struct Recorder {
  hal::VirtualClock clock{1'000'000'000};
  Eye eye{clock};
  TemporaryFolder folder;
  std::unique_ptr<RecordingSource> source;

  explicit Recorder(RecordingSettings settings = {}) {
    settings.path = folder / "eye.rec";
    settings.when_full = WhenFull::wait;
    source = RecordingSource::create(settings, eye, clock).value();
  }
  void read(int frames) {
    for (int k = 0; k < frames; ++k) static_cast<void>(source->read(clock.now_ns() + 100'000'000));
  }
  [[nodiscard]] std::string path() const { return folder / "eye.rec"; }
};

/// No file grows beyond it, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &usual_);
    rlimit now = usual_;
    now.rlim_cur = bytes;
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &now) == 0);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &usual_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit usual_{};
  void (*handler_)(int) = SIG_DFL;
};

}  // namespace

TEST_CASE("a recording reaches the disk every second, and its name at once") {
  Recorder recorder;
  data_flushes = folder_flushes = file_flushes = 0;
  REQUIRE(recorder.source->start());
  CHECK(folder_flushes == 1);
  recorder.read(450);
  CHECK(comes_true([&] { return recorder.source->recorded() == 450; }));
  recorder.source->stop();
  CHECK(data_flushes == 4);
  CHECK(file_flushes == 1);
}

TEST_CASE("the frames before an outage reach the disk while it lasts") {
  Recorder recorder;
  data_flushes = 0;
  REQUIRE(recorder.source->start());
  recorder.read(195);
  CHECK(comes_true([&] { return recorder.source->recorded() == 195; }));
  CHECK(data_flushes == 1);
  recorder.eye.silent = true;
  recorder.read(30);
  CHECK(comes_true([] { return data_flushes == 2; }));
  // Nothing is flushed twice.
  recorder.read(100);
  recorder.source->stop();
  CHECK(data_flushes == 2);
}

TEST_CASE("a recorder that gets no thread leaves no file, and the next start its own") {
  Recorder recorder;
  {
    const NoThreads none;
    const auto refused = recorder.source->start();
    check_error(refused, hal::ErrorCode::io, recorder.path(), {});
  }
  CHECK(recorder.folder.entries() == 0);
  CHECK_FALSE(recorder.eye.started());
  REQUIRE(recorder.source->start());
  recorder.source->stop();
  CHECK(recorder.source->path() == recorder.path());
  CHECK(recorder.folder.entries() == 1);
}

TEST_CASE("a full disk is told while the recording runs, and the file's own books agree") {
  const auto header_bytes = serialise(RecordingHeader{header_of(3, 12).source, 0, {}}).value().size();
  const std::size_t frame_bytes = frame_block_bytes(3, 12);
  for (const bool ends : {false, true}) {
    CAPTURE(ends);
    RecordingSettings settings;
    settings.stop_on_failure = ends;
    Recorder recorder(settings);
    const FileSizeLimit limit(header_bytes + 10 * frame_bytes + frame_bytes - 1);
    REQUIRE(recorder.source->start());
    recorder.read(12);
    REQUIRE(comes_true([&] { return recorder.source->failed(); }));
    REQUIRE(recorder.source->error().has_value());
    check_error(*recorder.source->error(), hal::ErrorCode::no_space, recorder.path(), {});
    const auto read = recorder.source->read(recorder.clock.now_ns() + 100'000'000);
    CHECK(read.has_value() != ends);
    if (ends) check_error(read, hal::ErrorCode::no_space, recorder.path(), {});
    recorder.source->stop();
    CHECK(recorder.source->recorded() == 10);
    // How many the eye gave before the writer's thread had met the end of the disk is that thread's affair.
    CHECK(recorder.source->unrecorded() == recorder.eye.account().delivered - 10);
    if (!ends) CHECK(recorder.source->unrecorded() == 3);
    auto reader = RecordingReader::open(recorder.path());
    REQUIRE(reader);
    while (reader->next()) {
    }
    CHECK(reader->frames() == 10);
    CHECK(reader->damage().torn_bytes == 0);
    CHECK(reader->end().has_value());
    CHECK(reader->unrecorded() == recorder.source->unrecorded());
    CHECK(reader->account().balanced());
  }
}

TEST_CASE("a recording ends with its books wherever the disk is full, if need be in the place of its last frame") {
  const auto header_bytes = serialise(RecordingHeader{header_of(3, 12).source, 0, {}}).value().size();
  const std::size_t frame_bytes = frame_block_bytes(3, 12);
  std::vector<std::size_t> bytes_left;
  for (std::size_t left = 0; left < frame_bytes; ++left) {
    const bool turns = left == 0 || left + 1 == end_block_bytes || left == end_block_bytes || left + 1 == frame_bytes;
    if (!compueye::test::sanitized || turns || left % 10 == 0) bytes_left.push_back(left);
  }
  for (const std::size_t left : bytes_left) {
    for (const int frames : {3, 5}) {  // as many as fit, and more
      CAPTURE(left);
      CAPTURE(frames);
      Recorder recorder;
      const FileSizeLimit limit(header_bytes + 3 * frame_bytes + left);
      REQUIRE(recorder.source->start());
      recorder.read(frames);
      recorder.source->stop();
      const std::uint64_t fit = left < end_block_bytes ? 2 : 3;
      CHECK(recorder.source->recorded() == fit);
      CHECK(recorder.source->recorded() + recorder.source->unrecorded() == static_cast<std::uint64_t>(frames));
      CHECK(recorder.source->error().has_value() == (frames > 3 || fit < 3));
      auto reader = RecordingReader::open(recorder.path());
      REQUIRE(reader);
      while (reader->next()) {
      }
      CHECK(reader->frames() == fit);
      CHECK(reader->damage().torn_bytes == 0);
      REQUIRE(reader->end());
      CHECK(reader->unrecorded() == recorder.source->unrecorded());
      CHECK(reader->account().produced == static_cast<std::uint64_t>(frames));
    }
  }
}

TEST_CASE("a pipe without a reader is refused and not waited for, and a link is never written through") {
  const TemporaryFolder folder;
  const auto pipe = folder / "pipe", link = folder / "link";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const auto header = header_of(3, 12);
  check_error(RecordingWriter::create(pipe, header), hal::ErrorCode::io, pipe, {});
  std::filesystem::create_symlink(folder / "elsewhere", link);
  check_error(RecordingWriter::create(link, header), hal::ErrorCode::io, link, {});
  CHECK_FALSE(std::filesystem::exists(folder / "elsewhere"));
}

TEST_CASE("what a source says of itself it says through its recorder, too") {
  Recorder recorder;
  REQUIRE(recorder.source->start());
  CHECK_FALSE(recorder.source->recovering());
  recorder.eye.silent = true;
  CHECK(recorder.source->recovering());
  CHECK(recorder.source->faults() == 3);
  CHECK(hal::text_of(recorder.source->counters()) == "silence 3, restart 2");
}

TEST_CASE("a frame that is not in the file is told by the next one that is, so that a torn recording tells it, too") {
  Recorder recorder;
  REQUIRE(recorder.source->start());
  recorder.read(5);
  recorder.eye.first_code = 1 << 20;  // more than its 12 bits
  recorder.read(2);
  recorder.eye.first_code = 1;
  recorder.read(1);
  CHECK(comes_true([&] { return recorder.source->recorded() == 6; }));
  recorder.source->stop();
  CHECK(recorder.source->unrecorded() == 2);
  auto reader = RecordingReader::open(recorder.path());
  REQUIRE(reader);
  for (int frame = 0; frame < 5; ++frame) REQUIRE(reader->next());
  CHECK(reader->unrecorded() == 0);
  REQUIRE(reader->next());
  CHECK(reader->unrecorded() == 2);
  CHECK_FALSE(reader->end());
}

TEST_CASE("a recording whose reader was interrupted has been stopped, and its source has not failed") {
  Recorder recorder;
  REQUIRE(recorder.source->start());
  recorder.read(5);
  recorder.eye.interrupted = true;
  recorder.read(1);
  recorder.source->stop();
  auto reader = RecordingReader::open(recorder.path());
  REQUIRE(reader);
  while (reader->next()) {
  }
  REQUIRE(reader->end());
  CHECK(reader->end()->ending == Ending::stopped);
}
