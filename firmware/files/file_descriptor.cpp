#include "firmware/files/file_descriptor.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

struct Advice {
  hal::ErrorCode code;
  std::string_view reason;  // empty: the system's own words
  std::string_view remedy;
};

Advice advice_for(int error_number) {
  using hal::ErrorCode;
  switch (error_number) {
    case ENOENT:
      return {ErrorCode::not_found, "it, or the folder it is in, does not exist", "check the name or make the folder"};
    case ENOTDIR:
      return {ErrorCode::not_found, "a part of its path is a file and not a folder", "check the path"};
    case EISDIR:
      return {ErrorCode::io, "it is a folder", "name a file"};
    case EACCES:
    case EPERM:
      return {ErrorCode::io, "permission is denied", "check who owns it and what its folder allows"};
    case EROFS:
      return {ErrorCode::io, "it is on a read-only file system", "choose another folder"};
    case ENOSPC:
      return {ErrorCode::no_space, "no space is left on the device", "free some space or choose another disk"};
    case EDQUOT:
      return {ErrorCode::no_space, "the disk quota is used up", "free some space or choose another disk"};
    case EFBIG:
      return {ErrorCode::no_space, "it would exceed the largest allowed file size",
              "raise the limit (ulimit -f) or write less"};
    case EEXIST:
      return {ErrorCode::io, "there is one already, which is never overwritten", "choose another name or remove it"};
    case ENXIO:
      return {ErrorCode::io, "nobody reads this pipe", "start its reader first"};
    case ELOOP:
      return {ErrorCode::io, "its symbolic links lead in a circle", "name the file itself"};
    case ENAMETOOLONG:
      return {ErrorCode::io, "its name is too long", "choose a shorter name"};
    case EMFILE:
    case ENFILE:
      return {ErrorCode::io, "too many files are open", "raise the limit (ulimit -n)"};
    default:
      return {ErrorCode::io, {}, {}};
  }
}

}  // namespace

hal::Error file_error(int error_number, const std::string& path, std::string_view action) {
  const Advice advice = advice_for(error_number);
  std::string sentence(action);
  sentence += ": ";
  sentence += advice.reason.empty() ? std::generic_category().message(error_number) : std::string(advice.reason);
  if (!advice.remedy.empty()) sentence.append("; ").append(advice.remedy);
  return {advice.code, path, std::move(sentence)};
}

FileDescriptor::FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

FileDescriptor::~FileDescriptor() {
  close();
}

int FileDescriptor::close() noexcept {
  if (fd_ < 0) return 0;
  return ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno;
}

hal::Result<FileDescriptor> open_for_reading(const std::string& path) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return tl::unexpected(file_error(errno, path, "cannot be opened"));
  struct stat status {};
  if (::fstat(file.get(), &status) == 0 && S_ISDIR(status.st_mode)) {
    return tl::unexpected(file_error(EISDIR, path, "cannot be read"));
  }
  return file;
}

hal::Result<FileDescriptor> open_own(const std::string& path) {
  // Neither through a link nor into a wait for whoever writes a pipe.
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  const int why = file.is_open() ? 0 : errno;
  const auto unbelieved = [&](const std::string& what) {
    return hal::fail(hal::ErrorCode::stale, path, what + ", so what it holds is not believed");
  };
  if (why == ELOOP) return unbelieved("is a symbolic link");
  struct stat status {};
  if (why == ENXIO || (why == 0 && ::fstat(file.get(), &status) == 0 && !S_ISREG(status.st_mode))) {
    return unbelieved("is no regular file");
  }
  if (why != 0) return tl::unexpected(file_error(why, path, "cannot be opened"));
  if (status.st_uid != ::geteuid() && status.st_uid != 0) {
    return unbelieved("belongs to user " + std::to_string(status.st_uid));
  }
  // A group of one's own, as most systems give everybody, is no other.
  if ((status.st_mode & S_IWOTH) != 0 || ((status.st_mode & S_IWGRP) != 0 && status.st_gid != ::getegid())) {
    return unbelieved("can be written by others");
  }
  return file;
}

void remove_unless_own(const std::string& path) {
  if (!open_own(path)) ::unlink(path.c_str());
}

std::optional<std::uint64_t> regular_size(const FileDescriptor& file) noexcept {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return static_cast<std::uint64_t>(status.st_size);
}

hal::Result<std::size_t> read_some(const FileDescriptor& file, const std::string& path, std::span<std::byte> into) {
  std::size_t done = 0;
  while (done < into.size()) {
    const ssize_t got = ::read(file.get(), into.data() + done, into.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return tl::unexpected(file_error(errno, path, "cannot be read"));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

int write_all(int fd, std::span<const std::byte> bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t put = ::write(fd, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return 0;
}

hal::Result<std::string> read_whole_file(const std::string& path, std::uint64_t max_bytes, const AcceptBegin& accept) {
  const FileDescriptor file = TRY(open_for_reading(path));
  constexpr std::size_t step = 1U << 20U;
  const auto known = regular_size(file);
  std::string text;
  for (std::size_t want = first_piece_bytes;; want = step) {
    if ((known && *known > max_bytes) || text.size() > max_bytes) {
      const std::string size = known ? "has " + std::to_string(*known) : "has more than " + std::to_string(max_bytes);
      return hal::fail(hal::ErrorCode::no_space, path, size + " bytes, expected at most " + std::to_string(max_bytes));
    }
    const std::size_t before = text.size();
    // A regular file is read in one go; one byte more than its size shows at once that its end is reached.
    if (before == first_piece_bytes && known && *known >= before) want = static_cast<std::size_t>(*known) - before + 1;
    text.resize(before + want);
    const std::size_t got = TRY(read_some(file, path, std::as_writable_bytes(std::span(text).subspan(before))));
    text.resize(before + got);
    if (before == 0 && accept) TRY(accept(text));
    if (got < want) return text;
  }
}

}  // namespace compueye::firmware
