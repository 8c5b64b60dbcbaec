// Where an output goes, what it never does wrong to, and what is left of one that was cut short.

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string>
#include <string_view>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/output_target.hpp"
#include "firmware/files/partial_file.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using namespace compueye::test;
using hal::ErrorCode;

namespace {

std::atomic<int> file_flushes{0}, folder_flushes{0};

constexpr uid_t nobody = 65534;

hal::Result<void> write_text(const std::string& path, std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

/// Runs `work` in a process of its own, as another user where one is named; its exit code.
template <class Work>
int in_a_process(uid_t user, Work work) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (user != 0 && (::setgid(user) != 0 || ::setuid(user) != 0)) ::_exit(99);
    ::_exit(work() ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool is_root() {
  if (::geteuid() == 0) return true;
  MESSAGE("SKIPPED: needs root to be somebody else");
  return false;
}

}  // namespace

// In libc's place, which it asks in turn: what is asked of the disk is counted.
extern "C" int fsync(int fd) {
  struct stat status {};
  ++(::fstat(fd, &status) == 0 && S_ISDIR(status.st_mode) ? folder_flushes : file_flushes);
  return static_cast<int>(::syscall(SYS_fsync, fd));
}

TEST_CASE("a file is on the disk before it has its name, and its name before commit() returns") {
  const TemporaryFolder folder;
  file_flushes = folder_flushes = 0;
  auto file = AtomicFile::create(folder / "a").value();
  REQUIRE(file.write("bytes").has_value());
  CHECK(file_flushes == 0);
  REQUIRE(file.commit().has_value());
  CHECK(file_flushes == 1);
  CHECK(folder_flushes == 1);
}

TEST_CASE("a link that leads nowhere stays one, and the file is made behind it") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "deep");
  std::filesystem::create_symlink("deep/../middle", folder / "link");
  std::filesystem::create_symlink(folder / "deep/file", folder / "middle");
  REQUIRE(write_text(folder / "link", "new").has_value());
  CHECK(std::filesystem::is_symlink(folder / "link"));
  CHECK(std::filesystem::is_symlink(folder / "middle"));
  CHECK(bytes_of(folder / "deep/file") == "new");
  std::filesystem::create_symlink("circle", folder / "circle");
  check_error(write_text(folder / "circle", "x"), ErrorCode::io, folder / "circle", {});
  std::filesystem::create_symlink("nowhere/file", folder / "lost");
  check_error(write_text(folder / "lost", "x"), ErrorCode::not_found, folder / "nowhere/file", {});
}

TEST_CASE("a link that somebody else planted is not written through") {
  if (!is_root()) return;
  const TemporaryFolder folder;
  ::chmod(folder.path().c_str(), 0777);
  folder.file("precious", "old");
  REQUIRE(in_a_process(nobody, [&] { return ::symlink("precious", (folder / "out.png").c_str()) == 0; }) == 0);
  check_error(write_text(folder / "out.png", "new"), ErrorCode::io, folder / "out.png", {std::to_string(nobody)});
  CHECK(bytes_of(folder / "precious") == "old");
  CHECK(folder.entries() == 2);
  // Whose folder it is may link as they like.
  REQUIRE(::chown(folder.path().c_str(), nobody, nobody) == 0);
  CHECK(write_text(folder / "out.png", "new").has_value());
  CHECK(bytes_of(folder / "precious") == "new");
}

TEST_CASE("files that replacing would do wrong to are refused") {
  const TemporaryFolder folder;
  const auto read_only = folder.file("read-only", "old"), twice = folder.file("twice", "old");
  ::chmod(read_only.c_str(), 0444);
  std::filesystem::create_hard_link(twice, folder / "other");
  check_error(write_text(read_only, "new"), ErrorCode::io, read_only, {});
  check_error(write_text(twice, "new"), ErrorCode::io, twice, {"2"});
  check_error(try_output(twice), ErrorCode::io, twice, {"2"});
  CHECK(bytes_of(read_only) == "old");
  CHECK(bytes_of(folder / "other") == "old");
  CHECK(folder.entries() == 3);
}

TEST_CASE("a file stays its owner's: root leaves it to them, anybody else is refused") {
  if (!is_root()) return;
  const TemporaryFolder folder;
  ::chmod(folder.path().c_str(), 0777);
  const auto theirs = folder.file("theirs", "old"), ours = folder.file("ours", "old");
  REQUIRE(::chown(theirs.c_str(), nobody, nobody) == 0);
  ::chmod(ours.c_str(), 0666);
  REQUIRE(write_text(theirs, "new").has_value());
  struct stat status {};
  REQUIRE(::stat(theirs.c_str(), &status) == 0);
  CHECK(status.st_uid == nobody);
  CHECK(status.st_gid == nobody);
  CHECK(in_a_process(nobody, [&] {
          const auto refused = write_text(ours, "new");
          return !refused && refused.error().code == ErrorCode::io && names(refused.error().sentence, "0");
        }) == 0);
  CHECK(bytes_of(ours) == "old");
}

TEST_CASE("the names of the process's own streams are known without /proc, and get bytes in their order") {
  CHECK(named_stream("-") == 1);
  CHECK(named_stream("/dev/stdout") == 1);
  CHECK(named_stream("/dev/stderr") == 2);
  CHECK(named_stream("/dev/fd/63") == 63);
  CHECK(named_stream("/proc/self/fd/7") == 7);
  for (const char* other : {"", "--", "stdout", "/dev/fd/", "/dev/fd/x", "/dev/fd/-1", "/dev/fd/1/2", "/dev/null"}) {
    CHECK_FALSE(named_stream(other).has_value());
  }
  const TemporaryFolder folder;
  const auto path = folder.file("redirected", "");
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  REQUIRE(::write(fd, "before ", 7) == 7);
  const std::string name = "/dev/fd/" + std::to_string(fd);
  CHECK(try_output(name).has_value());
  REQUIRE(write_text(name, "between").has_value());
  REQUIRE(::write(fd, " after", 6) == 6);
  ::close(fd);
  CHECK(bytes_of(path) == "before between after");
  CHECK(folder.entries() == 1);
  check_error(write_text(name, "x"), ErrorCode::io, name, {});
}

TEST_CASE("trying a pipe does not end it for its reader, and one without a reader is refused") {
  const TemporaryFolder folder;
  const auto path = folder / "pipe";
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  check_error(write_text(path, "x"), ErrorCode::io, path, {});
  const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  CHECK(try_output(path).has_value());
  char byte = 0;
  REQUIRE(write_text(path, "x").has_value());
  CHECK(::read(reader, &byte, 1) == 1);
  ::close(reader);
}

TEST_CASE("what dead processes left half-written is removed, and nothing else") {
  const TemporaryFolder folder;
  const auto target = folder / "a.npy";
  // A process that is killed while it writes, and one that lives on.
  CHECK(in_a_process(0, [&] {
          auto file = AtomicFile::create(target);
          return file && file->write("half").has_value() && ::raise(SIGKILL) == 0;
        }) == -1);
  REQUIRE(folder.entries() == 1);
  int ready[2];
  REQUIRE(::pipe2(ready, O_CLOEXEC) == 0);
  const pid_t living = ::fork();
  if (living == 0) {
    sweep_partials("/nowhere");
    PartialFile held{folder / ("a.npy." + std::to_string(::getpid()) + "-00000000000000ff.partial"), {}};
    held.file = FileDescriptor(::open(held.path.c_str(), O_RDWR | O_CREAT | O_EXCL, 0666));
    ::flock(held.file.get(), LOCK_EX);
    static_cast<void>(::write(ready[1], "r", 1) == 1);
    for (;;) ::pause();
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  folder.file("b.4000000-notours.partial", "x");
  folder.file("notes.partial", "x");
  std::filesystem::create_symlink("notes.partial", folder / "a.npy.1-0123456789abcdef.partial");
  CHECK(folder.entries() == 5);
  sweep_partials(folder.path());
  CHECK(folder.entries() == 4);
  ::kill(living, SIGKILL);
  ::waitpid(living, nullptr, 0);
  sweep_partials(folder.path());
  CHECK(folder.entries() == 3);
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_CASE("a process that is left early takes its partial files along") {
  const TemporaryFolder folder;
  auto given_up = AtomicFile::create(folder / "a").value();
  auto done = AtomicFile::create(folder / "b").value();
  REQUIRE(done.commit().has_value());
  CHECK(folder.entries() == 2);
  remove_partials();
  CHECK(folder.entries() == 1);
  CHECK(std::filesystem::exists(folder / "b"));
}
