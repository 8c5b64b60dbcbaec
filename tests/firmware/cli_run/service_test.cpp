#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>

#include "tests/firmware/cli_run/copied_board.hpp"
#include "tests/firmware/notify_socket.hpp"

using namespace compueye;
using namespace compueye::test;

namespace {

/// What systemd gives a service of Type=notify.
struct ServiceManager {
  explicit ServiceManager(const std::string& watchdog_us)
      : socket((folder / "notify").string()),
        notify("NOTIFY_SOCKET", (folder / "notify").string()),
        watchdog("WATCHDOG_USEC", watchdog_us),
        runtime("RUNTIME_DIRECTORY", folder.path().string()) {}

  TemporaryFolder folder;
  NotifySocket socket;
  Environment notify, watchdog, runtime;
};

/// Both its ends are this process's; nobody reads.
struct UnreadPipe {
  UnreadPipe() { REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0); }
  ~UnreadPipe() {
    for (const int end : ends) ::close(end);
  }
  std::array<int, 2> ends{};
};

std::string failures(const ServiceManager& manager) {
  return bytes_of(manager.folder / "failures");
}

}  // namespace

TEST_CASE("a service is ready with its first picture, feeds the watchdog, and stops in order") {
  const CopiedBoard board;
  const ServiceManager manager("400000");
  Program program(board.run_arguments({"--frames", "0", "--no-show"}));
  CHECK(manager.socket.hears("EXTEND_TIMEOUT_USEC=120000000\nSTATUS="));
  CHECK(manager.socket.hears("READY=1"));
  CHECK(failures(manager) == "1\n");
  CHECK(manager.socket.hears("WATCHDOG=1"));
  CHECK(manager.socket.hears("STATUS=picture live"));
  CHECK(manager.socket.hears("WATCHDOG=1"));
  program.signal(SIGTERM);
  CHECK(manager.socket.hears("STOPPING=1"));
  const Ended ended = program.wait();
  CHECK(ended.exit_code == 0);
  CHECK(contains(ended.err, "compueye: picture live\n"));
  CHECK(failures(manager) == "0\n");
}

TEST_CASE("a recording that takes nothing for too long sets the watchdog off, and the stage is named") {
  const CopiedBoard board;
  std::ofstream(board.path() / "board.toml", std::ios::app) << "\n[health]\nstuck_after_s = 0.3\n";
  const ServiceManager manager("60000000");
  const UnreadPipe reader;
  // Every frame is waited for, so whoever records holds the eye up.
  Program program(board.run_arguments({"--frames", "0", "--lossless", "--record", "-"}), reader.ends[1]);
  CHECK(manager.socket.hears("READY=1"));
  CHECK(manager.socket.hears("WATCHDOG=trigger"));
  program.signal(SIGKILL);
  CHECK(contains(program.wait().err, "acquire is stuck for 0."));
  CHECK(failures(manager) == "1\n");
}

TEST_CASE("a service that failed before says how long it waits, and can be stopped meanwhile") {
  const CopiedBoard board;
  const ServiceManager manager("10000000");
  std::ofstream(manager.folder / "failures") << "7\n";
  Program program(board.run_arguments({"--frames", "0"}));
  CHECK(manager.socket.hears("EXTEND_TIMEOUT_USEC=150000000\nSTATUS=waiting 30 s: it failed 7 times in a row before"));
  program.signal(SIGTERM);
  const Ended ended = program.wait();
  CHECK(ended.exit_code == 1);
  CHECK(failures(manager) == "0\n");
}

TEST_CASE("a run whose board cannot be read fails at once, and is counted") {
  const CopiedBoard board;
  board.change("name =", "nome =");
  const ServiceManager manager("10000000");
  CHECK(board.run({"--frames", "0"}).exit_code == 1);
  CHECK(failures(manager) == "1\n");
}

TEST_CASE("lines for the journal carry their priority") {
  const CopiedBoard board;
  const TemporaryFolder folder;
  const std::string path = (folder / "journal").string();
  const int fd = ::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  struct stat is {};
  REQUIRE(::fstat(fd, &is) == 0);
  const Environment stream("JOURNAL_STREAM", std::to_string(is.st_dev) + ":" + std::to_string(is.st_ino));
  const CopiedBoard broken;
  broken.change("name =", "nome =");
  CHECK(Program(broken.run_arguments({}), -1, fd).wait().exit_code == 1);
  ::close(fd);
  CHECK(bytes_of(path).starts_with("<3>compueye: "));
}

TEST_CASE("what the operating system refuses of real time is a note, and the run goes on") {
  const CopiedBoard board;
  std::ofstream(board.path() / "board.toml", std::ios::app) << "\n[realtime]\nacquire_cpus = [1000]\n";
  const Ended ended = board.run({"--frames", "5", "--json"});
  REQUIRE(ended.exit_code == 0);
  const auto json = nlohmann::json::parse(ended.out);
  CHECK(json["picture"]["granted"] == "nothing");
  CHECK(contains(json["notes"].dump(), "acquire_cpus = [1000] was refused"));
}

TEST_CASE("the unit is one that systemd knows, and exposes little") {
  const std::string unit = source_path("boards/systemd/compueye@.service");
  if (::access("/usr/bin/systemd-analyze", X_OK) != 0) {
    MESSAGE("skipped: systemd-analyze is not installed (package systemd)");
    return;
  }
  const std::string command = "systemd-analyze security --offline=true --threshold=20 --no-pager '" + unit + "' 2>&1";
  FILE* const pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string said;
  std::array<char, 512> room{};
  while (std::fgets(room.data(), room.size(), pipe) != nullptr) said += room.data();
  const int status = ::pclose(pipe);
  CHECK_MESSAGE(status == 0, said);
  CHECK_FALSE(contains(said, "Unknown"));
  CHECK(contains(said, "Overall exposure level"));
}
