#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <optional>
#include <string>

#include "tests/calib/eye_file/faulty_disk.hpp"
#include "tests/calib/eye_file/small_eye.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"
#include "tests/sanitized.hpp"

using namespace compueye;
using namespace compueye::calib;
using namespace compueye::calib::tests;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

constexpr int captures_before = 4, captures_after = 2;

/// What the program was told is stored.
struct Promised {
  bool created = false, session = false, ended = false, estimate = false, closed = false;
  int captures = 0;
};

/// A session with an estimate in between, until something fails.
Promised measure(const std::string& path) {
  Promised promised;
  auto file = EyeFile::create(path, small_eye());
  if (!file) return promised;
  promised.created = true;
  const auto session = file->begin_session(small_session());
  if (!session) return promised;
  promised.session = true;
  for (int k = 0; k < captures_before + captures_after; ++k) {
    if (k == captures_before) {
      if (!file->store_estimate(small_estimate({1}), small_response(), small_sigma(small_response()))) return promised;
      promised.estimate = true;
    }
    if (!file->append_capture(*session, small_capture(k))) return promised;
    ++promised.captures;
  }
  if (!file->end_session(*session)) return promised;
  promised.ended = true;
  promised.closed = file->close().has_value();
  return promised;
}

/// What is in the file is what was promised, whole, and at most the one thing more that was in hand.
void check_stored(EyeFile& file, const Promised& promised) {
  const auto sessions = file.sessions();
  REQUIRE_MESSAGE(sessions.has_value(), sessions.error().text());
  if (sessions->empty()) {
    CHECK_FALSE(promised.session);
    return;
  }
  CHECK(same(sessions->front().begun, small_session()));
  const bool ended = sessions->front().end.has_value();
  CHECK((ended || !promised.ended));
  CHECK((!ended || promised.captures == captures_before + captures_after));
  auto reader = *file.captures(1);
  int stored = 0;
  for (;; ++stored) {
    const auto capture = reader.next();
    REQUIRE_MESSAGE(capture.has_value(), capture.error().text());
    if (!*capture) break;
    CHECK(same(**capture, small_capture(stored)));
  }
  CHECK(stored >= promised.captures);
  CHECK(stored <= promised.captures + 1);
  const auto estimates = file.estimates();
  REQUIRE_MESSAGE(estimates.has_value(), estimates.error().text());
  CHECK((estimates->size() == 1 || !promised.estimate));
  for (const StoredEstimate& estimate : *estimates) {
    CHECK(promised.captures >= captures_before);
    const auto loaded = file.load_estimate(estimate.id);
    REQUIRE_MESSAGE(loaded.has_value(), loaded.error().text());
    CHECK(same(*loaded, small_estimate({1})));
    const auto response = file.load_response(estimate.id);
    REQUIRE_MESSAGE(response.has_value(), response.error().text());
    CHECK(same(response->response, small_response()));
  }
}

/// After the power is back: the file is there with what was promised; or its creation was cut, and can be made again.
void check_after_cut(const std::string& path, const Promised& promised) {
  const FaultyDisk quick;
  auto file = EyeFile::open(path, EyeFileMode::write);
  if (!file) {
    CAPTURE(file.error().text());
    CHECK_FALSE(promised.created);
    const bool nothing = file.error().code == ErrorCode::not_found || file.error().code == ErrorCode::bad_format;
    CHECK(nothing);
    file = EyeFile::create(path, small_eye());
    REQUIRE_MESSAGE(file.has_value(), file.error().text());
  }
  check_stored(*file, promised);
  // And goes on.
  const auto session = file->begin_session(small_session());
  REQUIRE_MESSAGE(session.has_value(), session.error().text());
  REQUIRE(file->append_capture(*session, small_capture(77)).has_value());
  REQUIRE(file->close().has_value());
  const auto again = EyeFile::open(path, EyeFileMode::read);
  REQUIRE(again.has_value());
  CHECK(same(**again->captures(*session)->next(), small_capture(77)));
}

}  // namespace

TEST_CASE("eye file: a power cut before any write, sync or deletion takes nothing that was stored") {
  const TemporaryFolder folder;
  std::int64_t operations = 0;
  {
    const FaultyDisk disk;
    const Promised all = measure(folder / "whole.eye");
    CHECK(all.closed);
    operations = disk.operations();
    CHECK(disk.syncs() > captures_before + captures_after);
  }
  CHECK(operations > 40);
  int cuts = 0;
  for (std::int64_t cut = 0; cut < operations; cut += test::sanitized ? 7 : 1) {
    for (std::uint64_t seed = 0; seed < (test::sanitized ? 1 : 3); ++seed, ++cuts) {
      CAPTURE(cut);
      CAPTURE(seed);
      const TemporaryFolder each;
      const std::string path = each / "F.eye";
      Promised promised;
      {
        FaultyDisk disk;
        disk.cut_before = cut;
        promised = measure(path);
        CHECK(disk.is_off());
        CHECK((!promised.closed || cut + 3 >= operations));  // the rest only tidies up
        disk.power_comes_back(seed + 1000 * static_cast<std::uint64_t>(cut));
      }
      check_after_cut(path, promised);
    }
  }
  MESSAGE(cuts, " cuts over ", operations, " operations");
}

TEST_CASE("eye file: a commit is on the disk before it is told") {
  const TemporaryFolder folder;
  FaultyDisk disk;
  auto file = *EyeFile::create(folder / "F.eye", small_eye());
  const std::int64_t session = *file.begin_session(small_session());
  for (int k = 0; k < 5; ++k) {
    const std::int64_t before = disk.syncs();
    REQUIRE(file.append_capture(session, small_capture(k)).has_value());
    CHECK(disk.syncs() > before);
  }
}

TEST_CASE("eye file: kill -9 between captures takes none that was stored") {
  for (const int killed_after : {0, 1, 7, 40}) {
    CAPTURE(killed_after);
    const TemporaryFolder folder;
    const std::string path = folder / "F.eye";
    int ends[2];
    REQUIRE(::pipe(ends) == 0);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      ::close(ends[0]);
      auto file = EyeFile::create(path, small_eye());
      const auto session = file ? file->begin_session(small_session()) : tl::unexpected(file.error());
      for (int k = 0; session && file->append_capture(*session, small_capture(k)); ++k) {
        if (::write(ends[1], "s", 1) != 1) ::_exit(1);
      }
      ::_exit(2);
    }
    ::close(ends[1]);
    int stored = 0;
    char byte = 0;
    while (stored < killed_after && ::read(ends[0], &byte, 1) == 1) ++stored;
    CHECK(stored == killed_after);
    // For no capture at all it has to be there first.
    while (stored == 0 && ::read(ends[0], &byte, 1) == 1) ++stored;
    ::kill(child, SIGKILL);
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    while (::read(ends[0], &byte, 1) == 1) ++stored;
    ::close(ends[0]);

    const int found = [&] {
      const auto reading = EyeFile::open(path, EyeFileMode::read);
      REQUIRE_MESSAGE(reading.has_value(), reading.error().text());
      return static_cast<int>(*reading->capture_count(1));
    }();
    CHECK(found >= stored);
    CHECK(found <= stored + 1);
    auto file = EyeFile::open(path, EyeFileMode::write);
    REQUIRE_MESSAGE(file.has_value(), file.error().text());
    auto reader = *file->captures(1);
    for (int k = 0; k < found; ++k) CHECK(same(**reader.next(), small_capture(k)));
    CHECK_FALSE(reader.next()->has_value());
    CHECK(*file->append_capture(1, small_capture(found)) == found);
    REQUIRE(file->close().has_value());
    CHECK(folder.entries() == 1);
  }
}
