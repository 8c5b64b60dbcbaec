#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "firmware/sinks/live_status.hpp"
#include "firmware/sinks/terminal_sink.hpp"
#include "hal/clock.hpp"
#include "tests/firmware/sinks_terminal.hpp"
#include "tests/hal/units.hpp"

using namespace compueye;
using namespace compueye::firmware;
using namespace compueye::test;
using hal::ErrorCode;
using hal::FrameFormat;

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

TEST_CASE("a pixel that is no number is black in the terminal") {
  const hal::VirtualClock clock;
  const auto shown = [&](float level) {
    const Pipe pipe;
    TerminalSink sink(clock, small_terminal(pipe));
    REQUIRE(sink.open({2, 2}).has_value());
    REQUIRE(sink.write(frame_of({level, level, level, level}, {2, 2})).has_value());
    return pipe.take();
  };
  CHECK(shown(std::nanf("")) == shown(0.0F));
  CHECK(shown(1.0F) != shown(0.0F));
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

TEST_CASE("a terminal that takes nothing costs its own frames and never waits") {
  const Pipe pipe;
  hal::VirtualClock clock;
  TerminalOptions options = small_terminal(pipe);
  ::fcntl(pipe.fd(), F_SETPIPE_SZ, 4096);
  options.columns = 80;
  options.lines = 24;
  TerminalSink sink(clock, options);
  REQUIRE(sink.open({40, 40}).has_value());
  std::vector<float> pixels(1600);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i % 7) / 7.0F;
  for (std::uint64_t n = 0; n < 20; ++n) {
    REQUIRE(sink.write(frame_of(pixels, {40, 40}, n)).has_value());
    clock.advance(1000);
  }
  CHECK(sink.frames_shown() == 1);
  CHECK(sink.frames_passed_over() == 19);
  // A shared description stays as it was for whoever else writes to it.
  CHECK((::fcntl(pipe.fd(), F_GETFL) & O_NONBLOCK) == 0);
  // What was begun is finished before the next picture, so that no escape sequence is torn.
  std::string all;
  for (std::uint64_t n = 20; sink.frames_shown() < 2 && n < 200; ++n) {
    all += pipe.take();
    REQUIRE(sink.write(frame_of(pixels, {40, 40}, n)).has_value());
    clock.advance(1000);
  }
  CHECK(sink.frames_shown() == 2);
  all += pipe.take();
  CHECK(all.find("frame 0\x1b[K") != std::string::npos);
  CHECK(sink.close().has_value());
}

TEST_CASE("the picture follows the size of the terminal") {
  const int control = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (control < 0 || ::grantpt(control) != 0 || ::unlockpt(control) != 0) {
    MESSAGE("SKIPPED: no pseudo-terminals here");
    return;
  }
  const int terminal = ::open(::ptsname(control), O_RDWR | O_NOCTTY | O_CLOEXEC);
  REQUIRE(terminal >= 0);
  const auto resize = [&](unsigned short lines, unsigned short columns) {
    const winsize size{lines, columns, 0, 0};
    REQUIRE(::ioctl(terminal, TIOCSWINSZ, &size) == 0);
  };
  const auto taken = [&] {
    std::string all;
    char piece[4096];
    for (ssize_t n = 0; (n = ::read(control, piece, sizeof piece)) > 0;) all.append(piece, static_cast<std::size_t>(n));
    return all;
  };
  hal::VirtualClock clock;
  TerminalOptions options;
  options.fd = terminal;
  options.min_interval_ns = 0;
  TerminalSink sink(clock, options);
  resize(11, 40);
  REQUIRE(sink.open({20, 20}).has_value());
  CHECK(sink.shown_rows() == 20);
  const std::vector<float> pixels(400, 0.5F);
  REQUIRE(sink.write(frame_of(pixels, {20, 20}, 1)).has_value());
  CHECK(count(taken(), "\x1b[2J") == 0);
  resize(21, 90);
  REQUIRE(sink.write(frame_of(pixels, {20, 20}, 2)).has_value());
  CHECK(sink.shown_rows() == 40);
  const std::string second = taken();
  CHECK(count(second, "\x1b[2J") == 1);
  CHECK(count(second, "\n") == 20);
  resize(6, 90);
  REQUIRE(sink.write(frame_of(pixels, {20, 20}, 3)).has_value());
  CHECK(sink.shown_rows() == 10);
  REQUIRE(sink.close().has_value());
  ::close(terminal);
  ::close(control);
}

TEST_CASE("the cursor is given back when the process stops, and taken again when it goes on") {
  const Pipe pipe;
  hal::VirtualClock clock;
  TerminalSink sink(clock, small_terminal(pipe));
  sink.give_back();
  CHECK(pipe.take().empty());
  REQUIRE(sink.open({4, 4}).has_value());
  const std::vector<float> pixels(16, 0.5F);
  REQUIRE(sink.write(frame_of(pixels, {4, 4}, 1)).has_value());
  static_cast<void>(pipe.take());
  sink.give_back();
  CHECK(pipe.take() == "\x1b[0m\x1b[?25h\n");
  clock.advance(1000);
  REQUIRE(sink.write(frame_of(pixels, {4, 4}, 2)).has_value());
  CHECK(pipe.take().empty());
  sink.take_again();
  REQUIRE(sink.write(frame_of(pixels, {4, 4}, 3)).has_value());
  const std::string again = pipe.take();
  CHECK(again.starts_with("\x1b[?25l\x1b[38;2;128"));
  CHECK(sink.frames_shown() == 2);
}

TEST_CASE("the line below the picture says how the run goes, within the terminal") {
  LiveStatus status;
  status.published(0, 5'000'000, false);
  status.published(3, 34'000'000, true);
  status.published(4, 34'000'000, false);
  StatusLine line(status);
  std::array<char, 160> room{};
  CHECK(line.print(0, room) == "-/s, age 34 ms, 2 dropped in 1 gap, 1 late, 0 faults");
  for (std::uint64_t n = 5; n < 25; ++n) status.published(n, 1'000'000, false);
  status.source_is(1, false);
  CHECK(line.print(2'000'000'000, room) == "10.0/s, age 1 ms, 2 dropped in 1 gap, 1 late, 1 fault");
  CHECK(line.print(0, std::span(room).first(5)).size() == 4);

  const Pipe pipe;
  const hal::VirtualClock clock;
  for (const int columns : {12, 30, 100}) {
    TerminalOptions options = small_terminal(pipe);
    options.columns = columns;
    TerminalSink sink(clock, options, &status);
    REQUIRE(sink.open({2, 2}).has_value());
    REQUIRE(sink.write(frame_of(std::vector<float>(4), {2, 2}, 7)).has_value());
    const std::string text = pipe.take();
    const std::size_t begin = text.rfind("frame 7");
    REQUIRE(begin != std::string::npos);
    CHECK(text.find("\x1b[K", begin) - begin < static_cast<std::size_t>(columns));
    CHECK((text.find("dropped", begin) != std::string::npos) == (columns == 100));
  }
}

TEST_CASE("the line says that no frame comes, and for how long, when that is longer than usual") {
  LiveStatus status;
  StatusLine line(status);
  std::array<char, 160> room{};
  CHECK(line.print(0, room).empty());
  CHECK(line.print(999 * ms, room).empty());
  CHECK(line.print(1000 * ms, room) == "silent 1.0 s, 0 dropped in 0 gaps, 0 late, 0 faults");
  status.published(0, ms, false);
  CHECK(line.print(1100 * ms, room).starts_with("0."));
  // Frames that take two seconds are late after six.
  status.published(1, ms, false);
  CHECK(line.print(3100 * ms, room).starts_with("1.0/s, age 1 ms, "));
  CHECK(line.print(9099 * ms, room).starts_with("0.0/s, "));
  CHECK(line.print(9100 * ms, room) == "silent 6.0 s, 0 dropped in 0 gaps, 0 late, 0 faults");
  status.published(2, ms, false);
  CHECK(line.print(9200 * ms, room).find("silent") == std::string::npos);
  status.source_is(2, true);
  CHECK(line.print(9300 * ms, room) == "recovering, silent 0.1 s, 0 dropped in 0 gaps, 0 late, 2 faults");
}

TEST_CASE("frames of checks are none that were dropped, and the line says that the eye is looked at") {
  LiveStatus status;
  std::atomic<std::uint64_t> checked = 0;
  std::atomic<bool> checking = false;
  status.checks_are_counted_by(checked, checking);
  StatusLine line(status);
  std::array<char, 160> room{};
  const auto drops = [&] { return std::pair(status.dropped(), status.gaps()); };
  status.published(0, ms, false);
  status.published(3, ms, false);
  CHECK(line.print(0, room).ends_with("2 dropped in 1 gap, 0 late, 0 faults"));
  checking = true;
  checked = 40;  // the last frames of the scene are still on their way
  status.published(4, ms, false);
  CHECK(drops() == std::pair(std::uint64_t{2}, std::uint64_t{1}));
  CHECK(line.print(100 * ms, room).find("silent") == std::string::npos);
  CHECK(line.print(4100 * ms, room) == "checking the eye, silent 4.0 s, 2 dropped in 1 gap, 0 late, 0 faults");
  checking = false;
  status.published(45, ms, false);
  CHECK(drops() == std::pair(std::uint64_t{2}, std::uint64_t{1}));
  status.published(47, ms, false);
  CHECK(drops() == std::pair(std::uint64_t{3}, std::uint64_t{2}));
}

TEST_CASE("the line says that the response does not fit as long as it does not") {
  LiveStatus status;
  status.published(0, 1'000'000, false);
  status.misfit_is(94.4);
  StatusLine line(status);
  std::array<char, 160> room{};
  CHECK(line.print(0, room) == "-/s, age 1 ms, 0 dropped in 0 gaps, 0 late, 0 faults, residual 94 x noise");
  status.misfit_is(0.0);
  status.left_out_are(3);
  CHECK(line.print(0, room).ends_with("0 faults, 3 channels left out"));
  status.left_out_are(0);
  CHECK(line.print(0, room).ends_with("0 faults"));
}

TEST_CASE("the line below the picture goes on while no frame comes") {
  const Pipe pipe;
  hal::VirtualClock clock;
  LiveStatus status;
  TerminalOptions options = small_terminal(pipe);
  options.columns = 100;
  TerminalSink sink(clock, options, &status);
  sink.tell();
  CHECK(pipe.take().empty());
  REQUIRE(sink.open({2, 2}).has_value());
  static_cast<void>(pipe.take());
  clock.advance(600'000'000);
  sink.tell();
  CHECK(pipe.take() == "\rno frame yet  \x1b[K");
  clock.advance(1'000'000'000);
  sink.tell();
  CHECK(pipe.take() == "\rno frame yet  silent 1.0 s, 0 dropped in 0 gaps, 0 late, 0 faults\x1b[K");
  const std::vector<float> pixels(4, 0.5F);
  status.published(7, 0, false);
  REQUIRE(sink.write(frame_of(pixels, {2, 2}, 7)).has_value());
  CHECK(pipe.take().starts_with("\r\x1b[38;2;128"));
  // A frame has told it just now.
  clock.advance(499'999'999);
  sink.tell();
  CHECK(pipe.take().empty());
  clock.advance(3'000'000'000);
  status.source_is(3, true);
  sink.tell();
  CHECK(pipe.take() == "\rframe 7  recovering, silent 3.5 s, 7 dropped in 1 gap, 0 late, 3 faults\x1b[K");
  sink.give_back();
  static_cast<void>(pipe.take());
  sink.tell();
  CHECK(pipe.take().empty());
}

TEST_CASE("a terminal without UTF-8 or without colours gets what it can show") {
  const hal::VirtualClock clock;
  const std::vector<float> pixels{0.0F, 1.0F, 0.0F, 1.0F};
  for (const TerminalColours colours : {TerminalColours::palette, TerminalColours::none}) {
    const Pipe pipe;
    TerminalOptions options = small_terminal(pipe, colours);
    options.look.half_blocks = colours == TerminalColours::none;
    TerminalSink sink(clock, options);
    REQUIRE(sink.open({2, 2}).has_value());
    REQUIRE(sink.write(frame_of(pixels, {2, 2})).has_value());
    const std::string text = pipe.take();
    CHECK(std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80U; }));
    CHECK(count(text, "\n") == 5);
    const bool coloured = colours != TerminalColours::none;
    CHECK((text.find("\x1b[48;5;16m     \x1b[48;5;231m     ") != std::string::npos) == coloured);
    CHECK((text.find("     @@@@@") != std::string::npos) == !coloured);
  }
}

TEST_CASE("the look of the terminal comes from the environment") {
  using Pairs = std::vector<std::pair<const char*, const char*>>;
  const auto look = [](const Pairs& set) {
    for (const char* name : {"COLORTERM", "NO_COLOR", "LC_ALL", "LC_CTYPE", "LANG"}) ::unsetenv(name);
    for (const auto& [name, value] : set) ::setenv(name, value, 1);
    return terminal_look_from_environment();
  };
  CHECK((look({}) == TerminalLook{TerminalColours::palette, false}));
  CHECK((look({{"LANG", "de_DE.UTF-8"}}) == TerminalLook{TerminalColours::palette, true}));
  CHECK((look({{"LANG", "C.utf8"}, {"COLORTERM", "truecolor"}}) == TerminalLook{TerminalColours::truecolor, true}));
  CHECK((look({{"LANG", "C.UTF-8"}, {"LC_ALL", "C"}}) == TerminalLook{TerminalColours::palette, false}));
  CHECK((look({{"LC_CTYPE", "en_US.UTF-8"}, {"COLORTERM", "yes"}}) == TerminalLook{TerminalColours::palette, true}));
  CHECK((look({{"NO_COLOR", "1"}, {"COLORTERM", "24bit"}}) == TerminalLook{TerminalColours::none, false}));
  CHECK((look({{"NO_COLOR", ""}, {"COLORTERM", "24bit"}}) == TerminalLook{TerminalColours::truecolor, false}));
  ::setenv("TERM", "dumb", 1);
  CHECK_FALSE(terminal_can_draw());
  ::unsetenv("TERM");
  CHECK_FALSE(terminal_can_draw());
  ::setenv("TERM", "xterm-256color", 1);
  CHECK(terminal_can_draw());
}
