#include "drivers/recording/recording_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace compueye::recording {
namespace {

using hal::ErrorCode;

ErrorCode code_of(int error_number) {
  if (error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG) return ErrorCode::no_space;
  if (error_number == ETIMEDOUT) return ErrorCode::timeout;
  return error_number == ENOENT || error_number == ENOTDIR ? ErrorCode::not_found : ErrorCode::io;
}

const char* remedy(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "; free some space or choose another disk";
    case EFBIG:
      return "; raise the limit (ulimit -f) or record less";
    case ENOENT:
    case ENOTDIR:
      return "; check the name and its folder";
    case EEXIST:
      return "; recordings are never overwritten, so choose another name or remove it";
    case ENXIO:
      return ", nobody reads this pipe; start its reader first";
    case ETIMEDOUT:
      return "; whoever reads this pipe takes nothing";
    default:
      return "";
  }
}

class FileBytes final : public StoredBytes {
 public:
  FileBytes(OpenFile file, std::string place, std::uint64_t size)
      : file_(std::move(file)), place_(std::move(place)), size_(size) {}

  [[nodiscard]] const std::string& place() const noexcept override { return place_; }
  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }
  [[nodiscard]] hal::Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) override {
    while (!into.empty()) {
      const ssize_t got = ::pread(file_.get(), into.data(), into.size(), static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return tl::unexpected(file_failure(errno, place_, "cannot be read"));
      if (got == 0) {
        return hal::fail(
            ErrorCode::io, place_,
            "was cut to " + std::to_string(offset) + " bytes while it was read, it had " + std::to_string(size_));
      }
      offset += static_cast<std::uint64_t>(got);
      into = into.subspan(static_cast<std::size_t>(got));
    }
    return {};
  }

 private:
  OpenFile file_;
  std::string place_;
  std::uint64_t size_;
};

class MemoryBytes final : public StoredBytes {
 public:
  MemoryBytes(std::vector<std::byte> bytes, std::string place) : bytes_(std::move(bytes)), place_(std::move(place)) {}

  [[nodiscard]] const std::string& place() const noexcept override { return place_; }
  [[nodiscard]] std::uint64_t size() const noexcept override { return bytes_.size(); }
  [[nodiscard]] hal::Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) override {
    if (!into.empty()) std::memcpy(into.data(), bytes_.data() + offset, into.size());
    return {};
  }

 private:
  std::vector<std::byte> bytes_;
  std::string place_;
};

}  // namespace

hal::Error file_failure(int error_number, const std::string& path, const char* action) {
  return {code_of(error_number), path,
          std::string(action) + ": " + std::generic_category().message(error_number) + remedy(error_number)};
}

OpenFile::OpenFile(OpenFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

OpenFile::~OpenFile() {
  close();
}

int OpenFile::close() noexcept {
  if (fd_ < 0) return 0;
  return ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno;
}

hal::Result<std::unique_ptr<StoredBytes>> stored_file(const std::string& path) {
  // Without O_NONBLOCK the opening of a pipe would wait for its other end.
  OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) return tl::unexpected(file_failure(errno, path, "cannot be opened"));
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return tl::unexpected(file_failure(errno, path, "cannot be read"));
  if (!S_ISREG(status.st_mode)) {
    return hal::fail(ErrorCode::bad_format, path, "is not a regular file, expected a recording");
  }
  return std::make_unique<FileBytes>(std::move(file), path, static_cast<std::uint64_t>(status.st_size));
}

std::unique_ptr<StoredBytes> stored_memory(std::vector<std::byte> bytes, std::string place) {
  return std::make_unique<MemoryBytes>(std::move(bytes), std::move(place));
}

}  // namespace compueye::recording
