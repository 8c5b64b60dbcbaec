#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "firmware/files/npy.hpp"
#include "firmware/files/png.hpp"
#include "firmware/sinks/npy_sink.hpp"
#include "firmware/sinks/png_sequence_sink.hpp"
#include "firmware/sinks/sink_list.hpp"
#include "firmware/sinks/terminal_sink.hpp"
#include "hal/clock.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/memory/allocation_counter.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;
using hal::Frame;
using hal::FrameFormat;

namespace {

Frame frame_of(const std::vector<float>& pixels, FrameFormat format, std::uint64_t number = 0) {
  return {pixels, format, number, 0};
}

// A terminal as far as a sink can see: what it writes ends up in a pipe.
class Pipe {
 public:
  Pipe() {
    if (::pipe(ends_) != 0) std::abort();
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    ::fcntl(ends_[1], F_SETPIPE_SZ, 1 << 20);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  [[nodiscard]] int fd() const { return ends_[1]; }
  [[nodiscard]] std::string take() const {
    std::string all;
    char piece[4096];
    for (ssize_t n = 0; (n = ::read(ends_[0], piece, sizeof piece)) > 0;)
      all.append(piece, static_cast<std::size_t>(n));
    return all;
  }

 private:
  int ends_[2] = {-1, -1};
};

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

TerminalOptions small_terminal(const Pipe& pipe, TerminalColours colours = TerminalColours::truecolor) {
  TerminalOptions options;
  options.fd = pipe.fd();
  options.columns = 10;
  options.lines = 6;
  options.colours = colours;
  options.min_interval_ns = 100;
  return options;
}

}  // namespace

TEST_CASE("every sink refuses to write before open() and closes as often as asked") {
  const TemporaryFolder folder;
  const Pipe pipe;
  const hal::VirtualClock clock;
  std::vector<std::unique_ptr<hal::FrameSink>> sinks;
  sinks.push_back(std::make_unique<NpySink>(folder / "x.npy"));
  sinks.push_back(std::make_unique<PngSequenceSink>(folder / "png"));
  sinks.push_back(std::make_unique<TerminalSink>(clock, small_terminal(pipe)));
  const std::vector<float> pixels(6, 0.5F);
  const FrameFormat format{2, 3};
  for (const auto& sink : sinks) {
    CHECK(sink->write(frame_of(pixels, format)).error().code == ErrorCode::usage);
    CHECK(sink->close().has_value());
    CHECK(sink->open({0, 3}).error().code == ErrorCode::usage);
    CHECK(sink->open({2, -3}).error().code == ErrorCode::usage);
    REQUIRE(sink->open(format).has_value());
    CHECK(sink->open(format).error().code == ErrorCode::usage);
    CHECK(sink->write(frame_of(std::vector<float>(5), format)).error().code == ErrorCode::usage);
    CHECK(sink->write(frame_of(pixels, format)).has_value());
    CHECK(sink->close().has_value());
    CHECK(sink->close().has_value());
    CHECK(sink->open(format).has_value());
    CHECK(sink->close().has_value());
  }
}

TEST_CASE("every row of the list makes what it says, and what lies in the folder has the name it says") {
  const hal::VirtualClock clock;
  std::set<std::string_view> names;
  for (const SinkRow& row : sink_list()) {
    CAPTURE(row.name);
    CHECK(names.insert(row.name).second);
    CHECK((find_sink(row.name) == &row));
    CHECK(row.in_folder == !row.files.empty());
    if (!row.in_folder) continue;
    const TemporaryFolder folder;
    const auto sink = row.make(folder / "made", clock);
    const std::vector<float> pixels(6, 0.5F);
    REQUIRE(sink->open({2, 3}).has_value());
    REQUIRE(sink->write(frame_of(pixels, {2, 3})).has_value());
    REQUIRE(sink->close().has_value());
    const std::string pattern(row.files);
    const std::string beginning = pattern.substr(0, pattern.find('*'));
    REQUIRE(std::distance(std::filesystem::directory_iterator(folder / "made"), {}) == 1);
    const std::string made = std::filesystem::directory_iterator(folder / "made")->path().filename().string();
    CHECK(made.starts_with(beginning));
    CHECK(made.ends_with(pattern.substr(pattern.find('.'))));
  }
  CHECK((find_sink("jpeg") == nullptr));
}

TEST_CASE("png16 keeps more of a brightness than png") {
  const hal::VirtualClock clock;
  const auto kept = [&](std::string_view name) {
    const TemporaryFolder folder;
    const auto sink = find_sink(name)->make(folder / "made", clock);
    REQUIRE(sink->open({1, 2}).has_value());
    REQUIRE(sink->write(frame_of({0.3F, 0.3F}, {1, 2})).has_value());
    REQUIRE(sink->close().has_value());
    return read_png(std::filesystem::directory_iterator(folder / "made")->path()).value().pixels[0];
  };
  CHECK(kept("png16") == doctest::Approx(0.3).epsilon(3e-5));
  CHECK(kept("png") == doctest::Approx(77.0 / 255.0).epsilon(1e-6));
}

TEST_CASE("the formats are the rows that keep files, and none") {
  const std::vector<std::string_view> formats = sink_formats();
  CHECK(formats == std::vector<std::string_view>{"png", "png16", "npy", "none"});
  const std::string text = sink_formats_text();
  for (const std::string_view format : formats) CHECK(text.find(format) != std::string::npos);
  CHECK((find_sink("none")->make == nullptr));
  const hal::VirtualClock clock;
  CHECK((find_sink("terminal")->make("", clock) != nullptr));
}

TEST_CASE("the npy sink keeps every frame as it came") {
  const TemporaryFolder folder;
  NpySink sink(folder / "out/frames.npy");
  REQUIRE(sink.open({2, 2}).has_value());
  for (int f = 0; f < 4; ++f) {
    const std::vector<float> pixels{static_cast<float>(f), -1.5F, 2.5F, 0.1F};
    REQUIRE(sink.write(frame_of(pixels, {2, 2}, static_cast<std::uint64_t>(f))).has_value());
  }
  REQUIRE(sink.close().has_value());
  const auto back = read_pictures(folder / "out/frames.npy").value();
  CHECK(back.frames == 4);
  CHECK(back.values[12] == 3.0);
  CHECK(back.values[15] == static_cast<double>(0.1F));
}

TEST_CASE("a sink that goes away without close() still leaves whole files") {
  const TemporaryFolder folder;
  const std::vector<float> pixels(4, 0.5F);
  {
    NpySink npy(folder / "frames.npy");
    PngSequenceSink png(folder.path());
    REQUIRE(npy.open({2, 2}).has_value());
    REQUIRE(png.open({2, 2}).has_value());
    REQUIRE(npy.write(frame_of(pixels, {2, 2})).has_value());
    REQUIRE(png.write(frame_of(pixels, {2, 2})).has_value());
  }
  CHECK(read_pictures(folder / "frames.npy")->frames == 1);
  CHECK(read_png(folder / "frame-000000.png").has_value());
  CHECK(folder.entries() == 2);
}

TEST_CASE("PNGs are named by the frame's number and hold its picture") {
  const TemporaryFolder folder;
  const std::vector<float> pixels{0.0F, 0.25F, 1.0F, 1.5F, -1.0F, 0.5F};
  for (const int bits : {8, 16}) {
    PngSequenceSink sink(folder / "deep/er", bits);
    REQUIRE(sink.open({2, 3}).has_value());
    for (const std::uint64_t number : {0ULL, 7ULL, 1234567ULL, 18446744073709551615ULL}) {
      REQUIRE(sink.write(frame_of(pixels, {2, 3}, number)).has_value());
    }
    REQUIRE(sink.close().has_value());
    for (const char* name :
         {"frame-000000.png", "frame-000007.png", "frame-1234567.png", "frame-18446744073709551615.png"}) {
      const auto back = read_png(folder / "deep/er" / name);
      REQUIRE(back.has_value());
      const std::vector<float> expected{0.0F, 0.25F, 1.0F, 1.0F, 0.0F, 0.5F};
      for (std::size_t i = 0; i < 6; ++i)
        CHECK(std::abs(back->pixels[i] - expected[i]) <= (bits == 8 ? 0.002F : 1e-5F));
    }
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "deep/er"), {}) == 4);
  CHECK(PngSequenceSink(folder / "x", 12).open({2, 3}).error().code == ErrorCode::usage);
}

TEST_CASE("a folder that cannot be written is refused before the first frame") {
  const TemporaryFolder folder;
  folder.file("file", "x");
  for (const std::filesystem::path& bad : {folder / "file", folder / "file/sub",
                                           std::filesystem::path("/proc/compueye"), std::filesystem::path("/proc")}) {
    CAPTURE(bad.string());
    PngSequenceSink png(bad);
    const auto opened = png.open({2, 2});
    REQUIRE_FALSE(opened.has_value());
    CHECK(opened.error().place == bad.string());
    CHECK_FALSE(opened.error().sentence.empty());
    NpySink npy(bad / "x.npy");
    CHECK_FALSE(npy.open({2, 2}).has_value());
  }
  CHECK(folder.entries() == 1);
}

TEST_CASE("a picture that cannot be put in its place is an error and leaves no piece") {
  const TemporaryFolder folder;
  PngSequenceSink sink(folder.path());
  REQUIRE(sink.open({1, 1}).has_value());
  std::filesystem::create_directory(folder / "frame-000003.png");
  const std::vector<float> pixels{0.5F};
  const auto result = sink.write(frame_of(pixels, {1, 1}, 3));
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().place == (folder / "frame-000003.png").string());
  CHECK(folder.entries() == 1);
  CHECK(sink.write(frame_of(pixels, {1, 1}, 4)).has_value());
}

TEST_CASE("no sink allocates while frames flow") {
  const TemporaryFolder folder;
  const Pipe pipe;
  hal::VirtualClock clock;
  NpySink npy(folder / "x.npy");
  PngSequenceSink png8(folder / "png8"), png16(folder / "png16", 16);
  TerminalSink terminal(clock, small_terminal(pipe));
  const std::vector<float> pixels(160 * 160, 0.3F);
  const FrameFormat format{160, 160};
  for (hal::FrameSink* sink : {static_cast<hal::FrameSink*>(&npy), static_cast<hal::FrameSink*>(&png8),
                               static_cast<hal::FrameSink*>(&png16), static_cast<hal::FrameSink*>(&terminal)}) {
    REQUIRE(sink->open(format).has_value());
    const tests::HeapUse before = tests::heap_use_of_this_thread();
    bool ok = true;
    for (std::uint64_t n = 0; n < 5; ++n) {
      ok = sink->write(frame_of(pixels, format, n)).has_value() && ok;
      clock.advance(1000);
    }
    const tests::HeapUse used = tests::heap_use_of_this_thread() - before;
    CHECK(used.calls() == 0);
    CHECK(ok);
    CHECK(sink->close().has_value());
  }
}

TEST_CASE("the terminal shows two pixels a character and gives the cursor back") {
  const Pipe pipe;
  const hal::VirtualClock clock;
  TerminalSink sink(clock, small_terminal(pipe));
  REQUIRE(sink.open({2, 2}).has_value());
  CHECK(pipe.take() == "\x1b[?25l");
  CHECK(sink.shown_rows() == 10);
  CHECK(sink.shown_cols() == 10);
  REQUIRE(sink.write(frame_of({0.0F, 1.0F, 0.5F, 0.5F}, {2, 2}, 42)).has_value());
  const std::string first = pipe.take();
  CHECK(count(first, "\xe2\x96\x80") == 50);
  CHECK(count(first, "\n") == 5);
  // Five rows of the picture each: the third line has black and white above 50 % grey.
  CHECK(count(first, "\x1b[38;2;0;0;0m\x1b[48;2;128;128;128m") == 1);
  CHECK(count(first, "\x1b[38;2;255;255;255m") == 3);
  CHECK(first.find("frame 42") != std::string::npos);
  REQUIRE(sink.close().has_value());
  CHECK(pipe.take() == "\x1b[0m\x1b[?25h\n");
}

TEST_CASE("the terminal redraws in place and passes over frames that come too fast") {
  const Pipe pipe;
  hal::VirtualClock clock;
  TerminalSink sink(clock, small_terminal(pipe));
  REQUIRE(sink.open({4, 4}).has_value());
  const std::vector<float> pixels(16, 0.5F);
  REQUIRE(sink.write(frame_of(pixels, {4, 4}, 1)).has_value());
  CHECK(pipe.take().find("\x1b[?25l\x1b[38;2;128") == 0);
  clock.advance(99);
  REQUIRE(sink.write(frame_of(pixels, {4, 4}, 2)).has_value());
  CHECK(pipe.take().empty());
  clock.advance(1);
  REQUIRE(sink.write(frame_of(pixels, {4, 4}, 3)).has_value());
  const std::string second = pipe.take();
  CHECK(second.find("\r\x1b[4A") == 0);
  CHECK(second.find("frame 3") != std::string::npos);
  CHECK(sink.frames_shown() == 2);
}

TEST_CASE("a large picture is averaged down to the terminal and keeps its shape") {
  const Pipe pipe;
  const hal::VirtualClock clock;
  TerminalOptions options = small_terminal(pipe, TerminalColours::palette);
  options.columns = 40;
  options.lines = 11;
  TerminalSink sink(clock, options);
  REQUIRE(sink.open({160, 160}).has_value());
  CHECK(sink.shown_rows() == 20);
  CHECK(sink.shown_cols() == 20);
  // A fine checkerboard has no grey of its own: only its mean is left.
  std::vector<float> pixels(160 * 160);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = (i / 160 + i % 160) % 2 == 0 ? 1.0F : 0.0F;
  REQUIRE(sink.write(frame_of(pixels, {160, 160})).has_value());
  const std::string text = pipe.take();
  CHECK(count(text, "\x1b[38;5;244m") == 10);
  CHECK(count(text, "\x1b[48;5;244m") == 10);
  CHECK(count(text, "\x1b[38;") == 10);
}

TEST_CASE("odd sizes, NaN and extreme shapes stay inside the terminal") {
  const hal::VirtualClock clock;
  for (const FrameFormat format :
       {FrameFormat{1, 1}, FrameFormat{3, 1000}, FrameFormat{1000, 3}, FrameFormat{7, 5}, FrameFormat{17, 13}}) {
    CAPTURE(format.rows);
    const Pipe pipe;
    TerminalSink sink(clock, small_terminal(pipe));
    REQUIRE(sink.open(format).has_value());
    CHECK(sink.shown_cols() <= 10);
    CHECK(sink.shown_rows() <= 10);
    std::vector<float> pixels(static_cast<std::size_t>(format.rows * format.cols), std::nanf(""));
    pixels[0] = 1e30F;
    REQUIRE(sink.write(frame_of(pixels, format)).has_value());
    const std::string text = pipe.take();
    CHECK(count(text, "\n") == static_cast<std::size_t>((sink.shown_rows() + 1) / 2));
    CHECK(count(text, "\xe2\x96\x80") == count(text, "\n") * static_cast<std::size_t>(sink.shown_cols()));
    CHECK(text.find(";-") == std::string::npos);
  }
}

TEST_CASE("a terminal that cannot be written is an error") {
  const hal::VirtualClock clock;
  TerminalOptions options;
  options.fd = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  TerminalSink full(clock, options);
  CHECK(full.open({2, 2}).error().code == ErrorCode::no_space);
  ::close(options.fd);
  options.fd = -1;
  TerminalSink closed(clock, options);
  CHECK(closed.open({2, 2}).error().code == ErrorCode::io);
}

TEST_CASE("the colours of the terminal come from the environment") {
  ::setenv("COLORTERM", "truecolor", 1);
  CHECK(terminal_colours_from_environment() == TerminalColours::truecolor);
  ::setenv("COLORTERM", "yes", 1);
  CHECK(terminal_colours_from_environment() == TerminalColours::palette);
  ::unsetenv("COLORTERM");
  CHECK(terminal_colours_from_environment() == TerminalColours::palette);
}
