#include "firmware/files/output_target.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "firmware/files/file_descriptor.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

namespace fs = std::filesystem;
using hal::ErrorCode;
using hal::Result;

constexpr int most_links = 40;  // the kernel's own

/// As the kernel's fs.protected_symlinks has it, but in every folder: an output may go through a link that its user,
/// root or the owner of the folder made.
Result<void> check_link(const fs::path& link, const struct stat& status) {
  if (status.st_uid == ::geteuid() || status.st_uid == 0) return {};
  struct stat folder {};
  const fs::path parent = link.parent_path();
  if (::stat(parent.empty() ? "." : parent.c_str(), &folder) == 0 && folder.st_uid == status.st_uid) return {};
  return hal::fail(ErrorCode::io, link.string(),
                   "is a symbolic link that user " + std::to_string(status.st_uid) +
                       " made in somebody else's folder, so nothing is written through it; remove it or choose another "
                       "folder");
}

Result<void> check_replaceable(const std::string& path, const struct stat& status) {
  if ((status.st_mode & 0222U) == 0 || ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) {
    return hal::fail(ErrorCode::io, path,
                     "is read-only, so it is not replaced; make it writable or choose another name");
  }
  if (status.st_uid != ::geteuid() && ::geteuid() != 0) {
    return hal::fail(ErrorCode::io, path,
                     "belongs to user " + std::to_string(status.st_uid) +
                         ", from whom replacing it would take it; choose another name");
  }
  if (status.st_nlink > 1) {
    return hal::fail(ErrorCode::io, path,
                     "has " + std::to_string(status.st_nlink) +
                         " names (hard links), all but this one of which would keep the old bytes; remove this name "
                         "or choose another");
  }
  return {};
}

}  // namespace

std::optional<int> named_stream(const std::string& name) noexcept {
  if (name == "-" || name == "/dev/stdout") return STDOUT_FILENO;
  if (name == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!name.starts_with(folder)) continue;
    int fd = -1;
    const char* const end = name.data() + name.size();
    const auto read = std::from_chars(name.data() + folder.size(), end, fd);
    if (read.ec == std::errc{} && read.ptr == end && fd >= 0) return fd;
  }
  return std::nullopt;
}

Result<OutputTarget> output_target(const std::string& name) {
  fs::path path = name;
  struct stat status {};
  int links = 0;
  while (::lstat(path.c_str(), &status) == 0 && S_ISLNK(status.st_mode)) {
    TRY(check_link(path, status));
    std::error_code error;
    const fs::path to = fs::read_symlink(path, error);
    if (error || ++links > most_links)
      return tl::unexpected(file_error(error ? error.value() : ELOOP, name, cannot_write));
    path = path.parent_path() / to;
  }
  OutputTarget target{path.string(), std::nullopt};
  if (::stat(path.c_str(), &status) != 0) {
    if (name.back() == '/') return tl::unexpected(file_error(EISDIR, name, cannot_write));
    return target;
  }
  if (S_ISDIR(status.st_mode)) return tl::unexpected(file_error(EISDIR, name, cannot_write));
  if (S_ISREG(status.st_mode)) TRY(check_replaceable(target.path, status));
  target.present = status;
  return target;
}

}  // namespace compueye::firmware
