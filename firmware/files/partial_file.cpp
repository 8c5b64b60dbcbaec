#include "firmware/files/partial_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX, not C
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view ending = ".partial";
constexpr std::size_t random_digits = 16;

/// The process's, since it may be left at any moment by a thread that knows nothing of who writes what.
struct Registry {
  std::mutex mutex;
  std::vector<std::string> living;
  std::vector<std::string> swept_folders;
};

Registry& registry() {
  static Registry one;
  return one;
}

std::uint64_t random_number() noexcept {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number) {
    static std::atomic<std::uint64_t> counter{0};
    number = ++counter;
  }
  return number;
}

// The suffix must fit behind the longest name a file system allows (255 bytes).
std::string partial_name(const fs::path& target) {
  std::string name = target.filename();
  char suffix[64];
  std::snprintf(suffix, sizeof suffix, ".%ld-%016" PRIx64 "%s", static_cast<long>(::getpid()), random_number(),
                ending.data());
  const std::size_t length = std::string_view(suffix).size();
  if (name.size() + length > 255 && name.size() <= 255) name.resize(255 - length);
  return target.parent_path() / (name + suffix);
}

/// The process in a partial file's name, 0 when it is none.
pid_t process_in(std::string_view name) noexcept {
  if (!name.ends_with(ending)) return 0;
  name.remove_suffix(ending.size());
  if (name.size() < random_digits + 1) return 0;
  const std::string_view digits = name.substr(name.size() - random_digits);
  name.remove_suffix(random_digits);
  const bool hex = digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
  if (!hex || !name.ends_with('-')) return 0;
  name.remove_suffix(1);
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos) return 0;
  pid_t process = 0;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + dot + 1, end, process);
  return read.ec == std::errc{} && read.ptr == end ? process : 0;
}

/// Nobody holds it. Where a file system knows no locks, the process's number has to do.
bool abandoned(int file, pid_t process) noexcept {
  if (::flock(file, LOCK_EX | LOCK_NB) == 0) return true;
  return errno != EWOULDBLOCK && ::kill(process, 0) != 0 && errno == ESRCH;
}

void sweep_once(const std::string& target) {
  const std::string folder = fs::path(target).parent_path().string();
  {
    const std::lock_guard lock(registry().mutex);
    auto& swept = registry().swept_folders;
    if (std::find(swept.begin(), swept.end(), folder) != swept.end()) return;
    swept.push_back(folder);
  }
  sweep_partials(folder);
}

}  // namespace

hal::Result<PartialFile> PartialFile::create(const std::string& target) {
  sweep_once(target);
  for (int attempt = 0; attempt < 100; ++attempt) {
    PartialFile made{partial_name(target), {}};
    made.file = FileDescriptor(::open(made.path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!made.file.is_open()) {
      if (errno == EEXIST) continue;
      break;
    }
    struct stat status {};
    // Whoever sweeps may have found it between those two lines.
    static_cast<void>(::flock(made.file.get(), LOCK_EX | LOCK_NB));
    if (::fstat(made.file.get(), &status) == 0 && status.st_nlink == 0) continue;
    const std::lock_guard lock(registry().mutex);
    registry().living.push_back(made.path);
    return made;
  }
  return tl::unexpected(file_error(errno, target, "cannot be written"));
}

void forget_partial(const std::string& path) noexcept {
  const std::lock_guard lock(registry().mutex);
  std::erase(registry().living, path);
}

void remove_partials() noexcept {
  const std::lock_guard lock(registry().mutex);
  for (const std::string& each : registry().living) ::unlink(each.c_str());
  registry().living.clear();
}

void sweep_partials(const std::string& folder) noexcept {
  const std::unique_ptr<DIR, int (*)(DIR*)> open(::opendir(folder.empty() ? "." : folder.c_str()), ::closedir);
  if (!open) return;
  const int in = ::dirfd(open.get());
  while (const dirent* const entry = ::readdir(open.get())) {
    const pid_t process = process_in(entry->d_name);
    if (process <= 0 || process == ::getpid()) continue;
    const FileDescriptor file(::openat(in, entry->d_name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat status {};
    if (!file.is_open() || ::fstat(file.get(), &status) != 0) continue;
    if (!S_ISREG(status.st_mode) || status.st_uid != ::geteuid() || !abandoned(file.get(), process)) continue;
    ::unlinkat(in, entry->d_name, 0);
  }
}

}  // namespace compueye::firmware
