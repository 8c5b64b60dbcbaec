#include "firmware/files/file_descriptor.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "firmware/files/file_error.hpp"

namespace compueye::firmware {

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

hal::Result<FileDescriptor> open_for_reading(const std::filesystem::path& path) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return tl::unexpected(file_error(errno, path, "cannot be opened"));
  struct stat status {};
  if (::fstat(file.get(), &status) == 0 && S_ISDIR(status.st_mode)) {
    return tl::unexpected(file_error(EISDIR, path, "cannot be read"));
  }
  return file;
}

std::optional<std::uint64_t> regular_size(const FileDescriptor& file) noexcept {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return static_cast<std::uint64_t>(status.st_size);
}

hal::Result<std::size_t> read_some(const FileDescriptor& file, const std::filesystem::path& path,
                                   std::span<std::byte> into) {
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

hal::Result<std::string> read_whole_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  auto file = open_for_reading(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  constexpr std::size_t step = 1U << 20U;
  const auto known = regular_size(*file);
  std::string text;
  for (;;) {
    // A regular file is read in one go; one byte more than its size shows at once that its end is reached.
    const std::size_t want = known && text.empty() && *known <= max_bytes ? static_cast<std::size_t>(*known) + 1 : step;
    if ((known && *known > max_bytes) || text.size() > max_bytes) {
      const std::string size = known ? "has " + std::to_string(*known) : "has more than " + std::to_string(max_bytes);
      return hal::fail(hal::ErrorCode::no_space, path.string(),
                       size + " bytes, expected at most " + std::to_string(max_bytes));
    }
    const std::size_t before = text.size();
    text.resize(before + want);
    auto got = read_some(*file, path, std::as_writable_bytes(std::span(text).subspan(before)));
    if (!got) return tl::unexpected(std::move(got.error()));
    text.resize(before + *got);
    if (*got < want) return text;
  }
}

}  // namespace compueye::firmware
