#include <doctest/doctest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <vector>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/npy.hpp"
#include "firmware/sinks/npy_sink.hpp"
#include "tests/firmware/temporary_folder.hpp"
#include "tests/hal/error_check.hpp"

using namespace compueye;
using namespace compueye::firmware;
using compueye::test::bytes_of;
using compueye::test::Named;
using compueye::test::TemporaryFolder;
using hal::ErrorCode;

namespace {

hal::Result<void> write_text(const std::filesystem::path& path, std::string_view text) {
  return write_file_atomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

hal::Frame frame_of(const std::vector<float>& pixels) {
  return {pixels, {}, 0, 0};
}

// Sets the largest allowed file size for a while; writing beyond it then fails like on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    rlimit now = old_;
    now.rlim_cur = bytes;
    ok_ = ::setrlimit(RLIMIT_FSIZE, &now) == 0;
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  rlimit old_{};
  bool ok_ = false;
  void (*handler_)(int) = SIG_DFL;
};

// A real file system of `bytes`, for root only.
class TinyDisk {
 public:
  TinyDisk(const std::filesystem::path& at, const char* options) : at_(at) {
    std::filesystem::create_directory(at_);
    mounted_ = ::mount("tmpfs", at_.c_str(), "tmpfs", 0, options) == 0;
    if (!mounted_) MESSAGE("skipped: a tiny disk cannot be mounted here (" << std::string(std::strerror(errno)) << ")");
  }
  TinyDisk(const TinyDisk&) = delete;
  TinyDisk& operator=(const TinyDisk&) = delete;
  ~TinyDisk() {
    if (mounted_) ::umount(at_.c_str());
  }
  [[nodiscard]] bool mounted() const { return mounted_; }

 private:
  std::filesystem::path at_;
  bool mounted_ = false;
};

}  // namespace

TEST_CASE("a file appears with commit() and not before") {
  const TemporaryFolder folder;
  const auto path = folder / "a.txt";
  {
    auto file = AtomicFile::create(path).value();
    REQUIRE(file.write("half").has_value());
    CHECK_FALSE(std::filesystem::exists(path));
    const std::filesystem::path partial = file.partial_path();
    CHECK(partial.extension() == ".partial");
    CHECK(partial.parent_path() == folder.path());
    CHECK(bytes_of(partial) == "half");
  }
  CHECK(folder.entries() == 0);
  REQUIRE(write_text(path, "whole").has_value());
  CHECK(bytes_of(path) == "whole");
  CHECK(folder.entries() == 1);
}

TEST_CASE("an older file stays whole until it is replaced, and keeps its permissions") {
  const TemporaryFolder folder;
  const auto path = folder.file("a.txt", "old");
  ::chmod(path.c_str(), 0640);
  {
    auto file = AtomicFile::create(path).value();
    REQUIRE(file.write("new").has_value());
    CHECK(bytes_of(path) == "old");
  }
  CHECK(bytes_of(path) == "old");
  REQUIRE(write_text(path, "new").has_value());
  CHECK(bytes_of(path) == "new");
  struct stat status {};
  ::stat(path.c_str(), &status);
  CHECK((status.st_mode & 0777U) == 0640U);
}

TEST_CASE("a symbolic link stays one and the file behind it is replaced") {
  const TemporaryFolder folder;
  const auto target = folder.file("target", "old");
  std::filesystem::create_symlink("target", folder / "link");
  REQUIRE(write_text(folder / "link", "new").has_value());
  CHECK(std::filesystem::is_symlink(folder / "link"));
  CHECK(bytes_of(target) == "new");
  CHECK(folder.entries() == 2);
}

TEST_CASE("trying an output leaves nothing behind and makes no folder") {
  const TemporaryFolder folder;
  folder.file("old", "kept");
  CHECK(try_output("").has_value());
  CHECK(try_output(folder / "new").has_value());
  CHECK(try_output(folder / "old").has_value());
  CHECK(bytes_of(folder / "old") == "kept");
  CHECK(folder.entries() == 1);
  const auto tried = try_output(folder / "missing/new");
  REQUIRE_FALSE(tried.has_value());
  CHECK(tried.error().code == ErrorCode::not_found);
  CHECK(tried.error().place == (folder / "missing/new").string());
}

TEST_CASE("a folder is made with those it lies in, or named") {
  const TemporaryFolder folder;
  folder.file("file", "x");
  CHECK(make_folder("").has_value());
  CHECK(make_folder(folder / "a/b").has_value());
  CHECK(make_folder(folder / "a/b").has_value());
  CHECK(std::filesystem::is_directory(folder / "a/b"));
  const auto made = make_folder(folder / "file/sub");
  REQUIRE_FALSE(made.has_value());
  CHECK(made.error().code == ErrorCode::not_found);
  CHECK(made.error().place == (folder / "file/sub").string());
}

TEST_CASE("a target that cannot be written is named with what to do, and nothing is left") {
  const TemporaryFolder folder;
  folder.file("file", "x");
  std::filesystem::create_directory(folder / "sub");
  struct Case {
    std::filesystem::path path;
    ErrorCode code;
    Named named;
  };
  const std::vector<Case> cases{
      {folder / "missing/a.npy", ErrorCode::not_found, {}},
      {folder / "file/a.npy", ErrorCode::not_found, {}},
      {folder / "sub", ErrorCode::io, {}},
      {folder / "sub/", ErrorCode::io, {}},
      {folder.path() / std::string(300, 'n'), ErrorCode::io, {}},
      {"/proc/compueye.npy", ErrorCode::not_found, {}},
  };
  for (const Case& c : cases) {
    CAPTURE(c.path.string());
    test::check_error(write_text(c.path, "x"), c.code, c.path.string(), c.named);
  }
  CHECK(write_text("", "x").error().code == ErrorCode::usage);
  CHECK(folder.entries() == 2);
}

TEST_CASE("a name as long as the file system allows still works") {
  const TemporaryFolder folder;
  const std::string name(255, 'n');
  REQUIRE(write_text(folder / name, "x").has_value());
  CHECK(bytes_of(folder / name) == "x");
}

TEST_CASE("a device is written to and never replaced") {
  const auto result = write_text("/dev/full", "x");
  test::check_error(result, ErrorCode::no_space, "/dev/full", {});
  CHECK(std::filesystem::is_character_file("/dev/full"));
  CHECK(write_text("/dev/null", "x").has_value());
  CHECK(std::filesystem::is_character_file("/dev/null"));
  CHECK(NpySink("/dev/null").open({2, 2}).error().code == ErrorCode::io);
}

TEST_CASE("a file size limit ends in an error and leaves the old file") {
  const TemporaryFolder folder;
  const auto path = folder.file("a.npy", "old");
  const std::vector<float> values(1 << 16, 1.0F);
  const std::int64_t shape[] = {1 << 16};
  const FileSizeLimit limit(100'000);
  REQUIRE(limit.ok());
  const auto result = write_npy(path, shape, std::span<const float>(values));
  REQUIRE_FALSE(result.has_value());
  CHECK(result.error().code == ErrorCode::no_space);
  CHECK(result.error().place == path.string());
  CHECK(bytes_of(path) == "old");
  CHECK(folder.entries() == 1);
}

TEST_CASE("a disk that fills up ends in an error and leaves nothing half-written") {
  const TemporaryFolder folder;
  const TinyDisk disk(folder / "disk", "size=64k");
  if (!disk.mounted()) return;
  const std::vector<float> values(1 << 16, 1.0F);
  const std::int64_t shape[] = {1 << 16};
  const auto result = write_npy(folder / "disk/a.npy", shape, std::span<const float>(values));
  test::check_error(result, ErrorCode::no_space, folder / "disk/a.npy", {});
  CHECK(std::filesystem::is_empty(folder / "disk"));
}

TEST_CASE("a read-only disk is refused with the file") {
  const TemporaryFolder folder;
  const TinyDisk disk(folder / "disk", "size=64k");
  if (!disk.mounted()) return;
  if (::mount("tmpfs", (folder / "disk").c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, "size=64k") != 0) {
    MESSAGE("skipped: a disk cannot be made read-only here");
    return;
  }
  const auto result = write_text(folder / "disk/a", "x");
  test::check_error(result, ErrorCode::io, folder / "disk/a", {});
}

TEST_CASE("frames are streamed and the header is right after close()") {
  const TemporaryFolder folder;
  const auto path = folder / "frames.npy";
  NpySink sink(path);
  for (const std::int64_t frames : {0, 1, 3}) {
    REQUIRE(sink.open({2, 3}).has_value());
    for (std::int64_t f = 0; f < frames; ++f) {
      const std::vector<float> picture(6, static_cast<float>(f) + 0.5F);
      REQUIRE(sink.write(frame_of(picture)).has_value());
    }
    REQUIRE(sink.close().has_value());
    CHECK(sink.write(frame_of(std::vector<float>(6))).error().code == ErrorCode::usage);
    CHECK(folder.entries() == 1);
    const auto back = read_pictures(path);
    if (frames == 0) {
      // Nothing to show, and said so, but a whole file all the same.
      test::check_error(back, ErrorCode::out_of_range, path, {"(0, 2, 3)"});
      CHECK(bytes_of(path).size() == 128);
    } else {
      REQUIRE(back.has_value());
      CHECK(back->frames == frames);
      CHECK(back->values.back() == static_cast<double>(frames) - 0.5);
    }
  }
}

TEST_CASE("when the disk fills up the frames that were written whole are kept") {
  const TemporaryFolder folder;
  const auto path = folder / "frames.npy";
  const std::vector<float> picture(100, 0.25F);
  NpySink sink(path);
  REQUIRE(sink.open({10, 10}).has_value());
  {
    const FileSizeLimit limit(128 + 400 * 5 + 123);
    REQUIRE(limit.ok());
    for (int f = 0; f < 5; ++f) REQUIRE(sink.write(frame_of(picture)).has_value());
    CHECK(sink.write(frame_of(picture)).error().code == ErrorCode::no_space);
    CHECK_FALSE(sink.write(frame_of(picture)).has_value());
    REQUIRE(sink.close().has_value());
  }
  const auto back = read_pictures(path);
  REQUIRE(back.has_value());
  CHECK(back->frames == 5);
  CHECK(back->values == std::vector<double>(500, 0.25));
  CHECK(folder.entries() == 1);
}
