// Nothing that somebody else does, or does not do, keeps a command from ending when it is asked to.

#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

#include "drivers/recording/recording_format.hpp"
#include "tests/firmware/cli_run/copied_board.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

/// A terminal, and what is on the other end of it.
class PseudoTerminal {
 public:
  PseudoTerminal() : control_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    if (control_ < 0 || ::grantpt(control_) != 0 || ::unlockpt(control_) != 0) return;
    terminal_ = ::open(::ptsname(control_), O_RDWR | O_NOCTTY | O_CLOEXEC);
    const winsize size{30, 80, 0, 0};
    ::ioctl(terminal_, TIOCSWINSZ, &size);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  ~PseudoTerminal() {
    ::close(terminal_);
    ::close(control_);
  }
  [[nodiscard]] int fd() const { return terminal_; }
  /// What was shown since the last time.
  [[nodiscard]] std::string shown() const {
    std::string all;
    char piece[4096];
    for (ssize_t n = 0; (n = ::read(control_, piece, sizeof piece)) > 0;)
      all.append(piece, static_cast<std::size_t>(n));
    return all;
  }
  /// Nobody reads any more, and there is no room.
  [[nodiscard]] bool full() const {
    int waiting = 0;
    return ::ioctl(control_, FIONREAD, &waiting) == 0 && waiting > 3000;
  }

 private:
  int control_;
  int terminal_ = -1;
};

template <class True>
bool comes_true(Program& program, True holds) {
  constexpr std::chrono::seconds limit{60};
  const auto began = std::chrono::steady_clock::now();
  while (program.running() && std::chrono::steady_clock::now() - began < limit) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

int waiting_in(int pipe) {
  int bytes = 0;
  return ::ioctl(pipe, FIONREAD, &bytes) == 0 ? bytes : 0;
}

/// A pipe of one page has no room for another block of the small board's frames.
constexpr int pipe_bytes = 4096;
bool is_full(int pipe) {
  return waiting_in(pipe) > pipe_bytes - static_cast<int>(recording::frame_block_bytes(64, 12));
}

/// A first signal, which is heard, and then others: those within a fifth of a second count as the same request.
Ended ended_by_second(Program& program, int first, int second) {
  program.signal(first);
  REQUIRE(comes_true(program, [&] { return program.heard(); }));
  static_cast<void>(comes_true(program, [&] {
    program.signal(second);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return false;
  }));
  return program.wait();
}

std::uintmax_t bytes_in(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  return error ? 0 : size;
}

}  // namespace

TEST_CASE("a terminal that takes nothing holds neither the frames nor the end of a run") {
  ::setenv("TERM", "xterm", 1);
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) {
    const CopiedBoard board;
    const PseudoTerminal terminal;
    const auto file = board.outside("eye.rec");
    Program program(board.run_arguments({"--frames", "0", "--record", file.string()}), terminal.fd(), terminal.fd());
    REQUIRE(comes_true(program, [&] { return terminal.full(); }));
    const auto at = bytes_in(file);
    CHECK(comes_true(program, [&] { return bytes_in(file) > at + 10'000; }));
    program.signal(number);
    const Ended ended = program.wait();
    CHECK_FALSE(ended.timed_out);
    CHECK(ended.exit_code >= 0);  // 1 when its summary had no room either
    CHECK(ended.exit_code <= 1);
  }
}

TEST_CASE("a live view says that no frame comes before the first one, too") {
  ::setenv("TERM", "xterm", 1);
  const CopiedBoard board;
  board.change("frame_rate_hz = ", "frame_rate_hz = 0.5 # ");
  const PseudoTerminal terminal;
  Program program(board.run_arguments({"--frames", "0"}), terminal.fd());
  std::string shown;
  CHECK(comes_true(program, [&] { return contains(shown += terminal.shown(), "no frame yet  silent "); }));
  program.signal(SIGTERM);
  CHECK_FALSE(program.wait().timed_out);
}

TEST_CASE("pictures that a terminal cannot show are left out with a word, once") {
  const CopiedBoard board;
  for (const char* const term : {"dumb", "", "xterm"}) {
    CAPTURE(term);
    ::setenv("TERM", term, 1);
    for (const bool asked : {true, false}) {
      const PseudoTerminal terminal;
      const auto arguments = board.run_arguments(asked ? std::vector<std::string>{"--frames", "2", "--show"}
                                                       : std::vector<std::string>{"--frames", "2"});
      const Ended ended = Program(arguments, terminal.fd()).wait();
      CHECK(ended.exit_code == 0);
      const bool draws = std::string_view(term) == "xterm";
      CHECK(contains(terminal.shown(), "\x1b[") == draws);
      const std::size_t at = ended.err.find("note: --show: ");
      CHECK((at != std::string::npos) == (asked && !draws));
      CHECK(ended.err.rfind("note: --show: ") == at);
    }
  }
}

TEST_CASE("a reader of the pictures that sleeps does not hold the run, whose files are whole") {
  const CopiedBoard board;
  int pipe[2];
  REQUIRE(::pipe2(pipe, O_CLOEXEC) == 0);
  ::fcntl(pipe[1], F_SETPIPE_SZ, pipe_bytes);
  const auto file = board.outside("eye.rec");
  Program program(board.run_arguments({"--frames", "0", "--show", "--record", file.string()}), pipe[1]);
  CHECK(comes_true(program, [&] { return bytes_in(file) > 20'000; }));
  program.signal(SIGTERM);
  const Ended ended = program.wait();
  CHECK_FALSE(ended.timed_out);
  CHECK(contains(test::compueye({"replay", file.string()}).out, "ended: stopped"));
  ::close(pipe[0]);
  ::close(pipe[1]);
}

TEST_CASE("a pipe that nobody reads is refused before the set-up") {
  const CopiedBoard board;
  const std::string pipe = board.outside("pipe.npy").string();
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const std::string at = board.path().string();
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"record", "--board", at, "--out", pipe},
        std::vector<std::string>{"run", "--board", at, "--frames", "0", "--record", pipe},
        std::vector<std::string>{"simulate", "--board", at, "--out", pipe},
        std::vector<std::string>{"response", "--board", at, "--out", pipe}}) {
    const Ended ended = test::compueye(arguments);
    CAPTURE(ended.err);
    CHECK(ended.exit_code == 1);
    CHECK_FALSE(ended.timed_out);
  }
}

TEST_CASE("a pipe that nobody writes is waited for until the first signal") {
  const CopiedBoard board;
  const std::string at = board.path().string(), pipe = board.outside("pipe").string();
  const std::string out = board.outside("out").string();
  const std::string array = board.outside("pipe.npy").string();
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  REQUIRE(::mkfifo(array.c_str(), 0600) == 0);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", "--board", at, "--frames", "0", "--scene", pipe},
        std::vector<std::string>{"record", "--board", at, "--scene", pipe, "--out", out},
        std::vector<std::string>{"compare", "--board", at, "--scene", pipe},
        std::vector<std::string>{"simulate", "--board", at, "--scene", pipe, "--out", out},
        std::vector<std::string>{"reconstruct", "--response", array, "--samples", array, "--size", "16x16", "--sigma",
                                 "1"}}) {
    CAPTURE(arguments[0]);
    Program program(arguments);
    REQUIRE(comes_true(program, [&] { return program.hears(SIGTERM); }));
    program.signal(SIGTERM);
    const Ended ended = program.wait();
    CHECK(ended.exit_code == 1);
    CHECK(contains(ended.err, "nothing was written"));
    CHECK_FALSE(std::filesystem::exists(out));
  }
}

TEST_CASE("a second signal ends at once what the first one could not") {
  const CopiedBoard board;
  const auto pipe = board.outside("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  REQUIRE(reader >= 0);
  ::fcntl(reader, F_SETPIPE_SZ, pipe_bytes);
  Program program({"record", "--board", board.path().string(), "--frames", "0", "--out", pipe.string()});
  // What is recorded then waits for a reader that never comes.
  REQUIRE(comes_true(program, [&] { return is_full(reader); }));
  const Ended ended = ended_by_second(program, SIGTERM, SIGINT);
  CHECK(ended.exit_code == 128 + SIGINT);
  CHECK(contains(ended.err, "signal"));
  ::close(reader);
}

TEST_CASE("every signal that asks a command to stop is heard by one that computes, too") {
  const CopiedBoard board;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    const auto out = board.outside("y.npy");
    Program program({"simulate", "--board", board.path().string(), "--frames", "1000000", "--out", out.string()});
    REQUIRE(comes_true(program, [&] { return program.hears(number) && program.computes(); }));
    program.signal(number);
    const Ended ended = program.wait();
    CHECK(ended.exit_code == 1);
    CHECK(contains(ended.err, "compueye: "));
    CHECK_FALSE(std::filesystem::exists(out));
    CHECK(partial_files(out.parent_path()) == 0);
  }
}

TEST_CASE("the cursor is given back by Ctrl-Z and by a second signal, and hidden again when the run goes on") {
  ::setenv("TERM", "xterm", 1);
  const CopiedBoard board;
  const PseudoTerminal terminal;
  const auto pipe = board.outside("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  REQUIRE(reader >= 0);
  ::fcntl(reader, F_SETPIPE_SZ, pipe_bytes);
  Program program(board.run_arguments({"--frames", "0", "--record", pipe.string()}), terminal.fd());
  std::string shown;
  const auto shows = [&](const std::string& what) {
    return [&, what] {
      shown += terminal.shown();
      return contains(shown, what);
    };
  };
  REQUIRE(comes_true(program, shows("frame ")));
  shown.clear();
  program.signal(SIGTSTP);
  CHECK(comes_true(program, shows("\x1b[?25h")));
  CHECK(comes_true(program, [&] { return program.stands(); }));
  shown.clear();
  program.signal(SIGCONT);
  CHECK(comes_true(program, shows("\x1b[?25l")));
  // The recorder's pipe is full by then, or soon: only a second signal ends the run.
  REQUIRE(comes_true(program, [&] {
    shown = terminal.shown();
    return is_full(reader);
  }));
  CHECK(ended_by_second(program, SIGTERM, SIGTERM).exit_code == 128 + SIGTERM);
  shown += terminal.shown();
  CHECK(contains(shown, "\x1b[?25h"));
  ::close(reader);
}
