#include <doctest/doctest.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "firmware/realtime/realtime.hpp"
#include "firmware/service/journal.hpp"
#include "firmware/service/restart_count.hpp"
#include "firmware/service/systemd_notifier.hpp"
#include "tests/firmware/notify_socket.hpp"
#include "tests/firmware/temporary_folder.hpp"

namespace {

using namespace compueye::firmware;
using compueye::test::Environment;
using compueye::test::NotifySocket;

TEST_CASE("systemd hears readiness, progress, trouble and the end as sd_notify(3) has it") {
  const compueye::test::TemporaryFolder folder;
  const std::string path = (folder / "notify").string();
  const NotifySocket systemd(path);
  const Environment socket("NOTIFY_SOCKET", path), watchdog("WATCHDOG_USEC", "10000000");
  const Environment pid("WATCHDOG_PID", std::to_string(::getpid()));
  REQUIRE(run_by_service_manager());
  const auto manager = service_manager_of_environment();
  CHECK(manager->watchdog_ns() == 10'000'000'000);
  manager->starting(30'000'000'000, "rows of A");
  CHECK(systemd.heard() == "EXTEND_TIMEOUT_USEC=30000000\nSTATUS=rows of A");
  manager->ready();
  CHECK(systemd.heard() == "READY=1");
  manager->alive();
  CHECK(systemd.heard() == "WATCHDOG=1");
  manager->status("held\nREADY=1");
  CHECK(systemd.heard() == "STATUS=held");
  manager->restart_me();
  CHECK(systemd.heard() == "WATCHDOG=trigger");
  manager->stopping();
  CHECK(systemd.heard() == "STOPPING=1");
}

TEST_CASE("without systemd nobody is told, and a socket that is gone is no trouble") {
  CHECK_FALSE(run_by_service_manager());
  CHECK(service_manager_of_environment()->watchdog_ns() == 0);
  const Environment socket("NOTIFY_SOCKET", "/nonexistent/notify");
  const auto manager = service_manager_of_environment();
  manager->ready();
  manager->alive();
  CHECK(manager->watchdog_ns() == 0);
}

TEST_CASE("the journal is known by its device and inode, and by nothing less") {
  const compueye::test::TemporaryFolder folder;
  const std::string path = (folder / "stderr").string();
  const int fd = ::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  struct stat is {};
  REQUIRE(::fstat(fd, &is) == 0);
  const std::string right = std::to_string(is.st_dev) + ":" + std::to_string(is.st_ino);
  CHECK_FALSE(is_journal(fd));
  {
    const Environment stream("JOURNAL_STREAM", right);
    CHECK(is_journal(fd));
    CHECK_FALSE(is_journal(-1));
  }
  for (const std::string& wrong : {std::string(), std::string(":"), right + "x", right + "1", "1" + right,
                                   std::to_string(is.st_dev), std::string("9:9")}) {
    CAPTURE(wrong);
    const Environment stream("JOURNAL_STREAM", wrong);
    CHECK_FALSE(is_journal(fd));
  }
  ::close(fd);
  CHECK(journal_prefix(4) == "<4>");
}

TEST_CASE("failures are counted until one start goes well, whatever was in the file") {
  const compueye::test::TemporaryFolder folder;
  const auto begin = [&] { return RestartCount((folder / "").string()).begin().value_or(999); };
  CHECK(begin() == 0);
  CHECK(begin() == 1);
  CHECK(begin() == 2);
  REQUIRE(RestartCount((folder / "").string()).forget().has_value());
  CHECK(begin() == 0);
  std::ofstream((folder / "failures").string(), std::ios::trunc) << "\xff\xfe";
  CHECK(begin() == 0);
  CHECK(begin() == 1);
  CHECK(RestartCount("").begin().value_or(999) == 0);
  CHECK_FALSE(RestartCount((folder / "nowhere/at/all").string()).begin().has_value());
}

TEST_CASE("what the system refuses of real time is said with what to do, each once, and the rest is granted") {
  RealtimeSettings wanted;
  // One that this machine gives us.
  const int cpu = ::sched_getcpu();
  REQUIRE(cpu >= 0);
  wanted.acquire_cpus = {cpu};
  Realtime granted(wanted);
  granted.begin_process();
  granted.begin_acquire();
  granted.begin_other();
  CHECK(granted.notes().empty());
  CHECK(granted.granted() == "acquire_cpus " + std::to_string(cpu));

  wanted.acquire_cpus = {1000};
  Realtime refused(wanted);
  refused.begin_acquire();
  refused.begin_acquire();
  REQUIRE(refused.notes().size() == 1);
  CHECK(refused.notes()[0].find("acquire_cpus = [1000] was refused") == 0);
  CHECK(refused.granted() == "nothing");

  wanted = {};
  wanted.priority = 40;
  Realtime urgent(wanted);
  urgent.begin_acquire();
  // Either it was granted, or a person is told how.
  CHECK((urgent.granted() == "SCHED_FIFO 40") == urgent.notes().empty());
  if (!urgent.notes().empty()) CHECK(urgent.notes()[0].find("LimitRTPRIO=") != std::string::npos);
}

}  // namespace
