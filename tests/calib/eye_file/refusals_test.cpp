// Files that are none, that somebody else has, and disks that do not want.

#include <doctest/doctest.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/calib/eye_file/faulty_disk.hpp"
#include "tests/calib/eye_file/small_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::calib;
using namespace compueye::calib::tests;
using compueye::test::check_error;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

constexpr EyeFileMode both_modes[] = {EyeFileMode::read, EyeFileMode::write};

void run_sql(const std::string& path, const char* sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
  REQUIRE(sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(database);
}

/// A process that has a file open until it goes away.
class Holder {
 public:
  Holder(const std::string& path, EyeFileMode mode) {
    int ready[2];
    REQUIRE(::pipe(ready) == 0);
    REQUIRE(::pipe(end_) == 0);
    child_ = ::fork();
    if (child_ == 0) {
      ::close(end_[1]);
      const auto file = EyeFile::open(path, mode);
      char byte = file ? 'y' : 'n';
      if (::write(ready[1], &byte, 1) != 1) ::_exit(1);
      while (::read(end_[0], &byte, 1) > 0) {
      }
      ::_exit(0);
    }
    ::close(end_[0]);
    ::close(ready[1]);
    char byte = 0;
    REQUIRE(::read(ready[0], &byte, 1) == 1);
    REQUIRE(byte == 'y');
    ::close(ready[0]);
  }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;
  ~Holder() {
    ::close(end_[1]);
    ::waitpid(child_, nullptr, 0);
  }

 private:
  int end_[2] = {-1, -1};
  pid_t child_ = -1;
};

/// Without the rights that let root read and write everything, while it lives.
class Unprivileged {
 public:
  Unprivileged() : was_(::geteuid()), works_(was_ != 0 || ::seteuid(65534) == 0) {}
  Unprivileged(const Unprivileged&) = delete;
  Unprivileged& operator=(const Unprivileged&) = delete;
  ~Unprivileged() { static_cast<void>(::seteuid(was_)); }
  [[nodiscard]] bool works() const noexcept { return works_; }

 private:
  uid_t was_;
  bool works_;
};

/// Leaves a file as kill -9 leaves it, with three captures in its log.
void make_cut_off_file(const std::string& path) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    auto file = EyeFile::create(path, small_eye());
    const auto session = file->begin_session(small_session());
    for (int k = 0; k < 3; ++k) {
      if (!file->append_capture(*session, small_capture(k))) ::_exit(1);
    }
    ::_exit(0);  // closes nothing
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(status == 0);
}

}  // namespace

TEST_CASE("eye file: what is no eye file is refused by name and left as it is") {
  const TemporaryFolder folder;
  const std::string text = folder.file("text.eye", "A = 1\n" + std::string(2000, 'x'));
  const std::string empty = folder.file("empty.eye", "");
  const std::string other = folder / "other.eye", wal = folder / "wal.eye", hollow = folder / "hollow.eye";
  run_sql(other, "PRAGMA application_id = 77; CREATE TABLE t(x); INSERT INTO t VALUES (1)");
  run_sql(wal, "PRAGMA journal_mode = WAL; CREATE TABLE eye(x)");
  run_sql(hollow, "CREATE TABLE t(x); DROP TABLE t");
  const std::string pipe = folder / "pipe.eye";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  for (const EyeFileMode mode : both_modes) {
    for (const std::string& path : {text, other, wal}) {
      const std::string before = test::bytes_of(path);
      check_error(EyeFile::open(path, mode), ErrorCode::bad_format, path, {});
      check_error(EyeFile::create(path, small_eye()), ErrorCode::io, path, {});
      CHECK(test::bytes_of(path) == before);
    }
    check_error(EyeFile::open(other, mode), ErrorCode::bad_format, other, {"77"});
    check_error(EyeFile::open(empty, mode), ErrorCode::bad_format, empty, {});
    check_error(EyeFile::open(hollow, mode), ErrorCode::bad_format, hollow, {});
    check_error(EyeFile::open(folder.path(), mode), ErrorCode::io, folder.path(), {});
    check_error(EyeFile::open(pipe, mode), ErrorCode::io, pipe, {});
    check_error(EyeFile::open(folder / "none.eye", mode), ErrorCode::not_found, folder / "none.eye", {});
    check_error(EyeFile::open(text + "/F.eye", mode), ErrorCode::not_found, text + "/F.eye", {});
    check_error(EyeFile::open("", mode), ErrorCode::not_found, "", {});
    check_error(EyeFile::open(":memory:", mode), ErrorCode::not_found, ":memory:", {});
  }
  check_error(EyeFile::create(folder.path(), small_eye()), ErrorCode::io, folder.path(), {});
  check_error(EyeFile::create(pipe, small_eye()), ErrorCode::io, pipe, {});
  check_error(EyeFile::create(folder / "none/F.eye", small_eye()), ErrorCode::not_found, folder / "none/F.eye", {});
  CHECK(EyeFile::create(empty, small_eye()).has_value());
  CHECK(EyeFile::create(hollow, small_eye()).has_value());
  CHECK(EyeFile::open(hollow, EyeFileMode::read).has_value());
}

TEST_CASE("eye file: one that is there is never overwritten, an eye that cannot be is not made") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  EyeIdentity eye = small_eye();
  eye.geometry.acceptance_rad = 9.0;
  check_error(EyeFile::create(path, eye), ErrorCode::out_of_range, path, {"120"});
  eye = small_eye();
  eye.geometry.pitch_mm = unknown;
  check_error(EyeFile::create(path, eye), ErrorCode::out_of_range, path, {});
  CHECK(folder.entries() == 0);
  make_small_file(path);
  const std::string before = test::bytes_of(path);
  check_error(EyeFile::create(path, small_eye()), ErrorCode::io, path, {});
  CHECK(test::bytes_of(path) == before);
}

TEST_CASE("eye file: a name that SQLite would take for something else is a name") {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  for (const char* name : {"file:x?mode=memory", ":memory:", "a b%20c'\".eye", "-x"}) {
    CAPTURE(name);
    {
      auto file = EyeFile::create(name, small_eye());
      REQUIRE_MESSAGE(file.has_value(), file.error().text());
    }
    CHECK(std::filesystem::exists(folder.path() / name));
    CHECK(EyeFile::open(name, EyeFileMode::read).has_value());
  }
  CHECK(folder.entries() == 4);
  std::filesystem::current_path(before);
}

TEST_CASE("eye file: one writer and no reader beside it, or many readers") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  make_small_file(path);
  {
    const Holder writer(path, EyeFileMode::write);
    for (const EyeFileMode mode : both_modes) check_error(EyeFile::open(path, mode), ErrorCode::io, path, {});
    check_error(EyeFile::create(path, small_eye()), ErrorCode::io, path, {});
  }
  {
    const Holder reader(path, EyeFileMode::read), another(path, EyeFileMode::read);
    CHECK(read_small_file(path).has_value());
  }
  {
    auto writer = EyeFile::open(path, EyeFileMode::write);
    REQUIRE(writer.has_value());
    for (const EyeFileMode mode : both_modes) check_error(EyeFile::open(path, mode), ErrorCode::io, path, {});
    CHECK(writer->append_capture(2, small_capture(13)).has_value());
    CHECK(writer->append_capture(2, small_capture(14)).has_value());
  }
  CHECK(*EyeFile::open(path, EyeFileMode::write)->capture_count(2) == 5);
  CHECK(folder.entries() == 1);
}

TEST_CASE("eye file: on a read-only disk it can be read, and says so to a writer") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  make_small_file(path);
  FaultyDisk disk;
  disk.read_only = true;
  CHECK(read_small_file(path).has_value());
  check_error(EyeFile::open(path, EyeFileMode::write), ErrorCode::io, path, {});
  CHECK(disk.operations() == 0);
}

TEST_CASE("eye file: a full disk loses nothing, and with space again it goes on") {
  const TemporaryFolder folder;
  const std::string path = folder / "F.eye";
  FaultyDisk disk;
  disk.full_after = 5000;
  check_error(EyeFile::create(path, small_eye()), ErrorCode::no_space, path, {});
  disk.full_after = -1;
  auto file = EyeFile::create(path, small_eye());
  REQUIRE_MESSAGE(file.has_value(), file.error().text());
  const std::int64_t session = *file->begin_session(small_session());
  for (int k = 0; k < 12; ++k) {
    CAPTURE(k);
    disk.full_after = k * 1111;
    const auto full = file->append_capture(session, small_capture(k));
    if (!full) check_error(full, ErrorCode::no_space, path, {});
    if (k == 0) CHECK_FALSE(full.has_value());
    disk.full_after = -1;
    CHECK(*file->capture_count(session) == (full ? k + 1 : k));
    if (!full) CHECK(*file->append_capture(session, small_capture(k)) == k);
  }
  disk.full_after = 20'000;
  check_error(file->store_estimate(small_estimate({1}),
                                   *recon::Response::from_dense(6, 1000, std::vector<double>(6000, 0.5)), {}),
              ErrorCode::no_space, path, {});
  disk.full_after = -1;
  CHECK(file->estimates()->empty());
  CHECK(file->store_estimate(small_estimate({1}), small_response(), {}).has_value());
  REQUIRE(file->close().has_value());
  const auto reading = EyeFile::open(path, EyeFileMode::read);
  auto captures = *reading->captures(session);
  for (int k = 0; k < 12; ++k) CHECK(same(**captures.next(), small_capture(k)));
}

TEST_CASE("eye file: permissions that are missing are told, and a whole file needs none but to be read") {
  const TemporaryFolder folder;
  const std::string whole = folder / "whole.eye", cut_off = folder / "cut-off.eye", secret = folder / "secret.eye";
  make_small_file(whole);
  make_small_file(secret);
  make_cut_off_file(cut_off);
  REQUIRE(::chmod(secret.c_str(), 0) == 0);
  REQUIRE(::chmod(folder.path().c_str(), 0555) == 0);
  {
    const Unprivileged unprivileged;
    if (!unprivileged.works()) {
      MESSAGE("SKIPPED: this root cannot become another user");
      return;
    }
    CHECK(read_small_file(whole).has_value());
    check_error(EyeFile::open(whole, EyeFileMode::write), ErrorCode::io, whole, {});
    check_error(EyeFile::open(secret, EyeFileMode::read), ErrorCode::io, secret, {});
    check_error(EyeFile::open(cut_off, EyeFileMode::read), ErrorCode::io, cut_off, {"--resume"});
    check_error(EyeFile::create(folder / "new.eye", small_eye()), ErrorCode::io, folder / "new.eye", {});
  }
  REQUIRE(::chmod(folder.path().c_str(), 0755) == 0);
  REQUIRE(EyeFile::open(cut_off, EyeFileMode::write).has_value());
  CHECK(*EyeFile::open(cut_off, EyeFileMode::read)->capture_count(1) == 3);
  CHECK(folder.entries() == 3);
}
