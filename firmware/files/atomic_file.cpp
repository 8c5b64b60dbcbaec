#include "firmware/files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

constexpr std::string_view cannot_write = "cannot be written";

std::atomic<unsigned> partial_counter{0};

// The suffix must fit behind the longest name a file system allows (255 bytes).
std::string partial_name(const std::filesystem::path& target) {
  std::string name = target.filename();
  const std::string suffix = "." + std::to_string(::getpid()) + "-" + std::to_string(partial_counter++) + ".partial";
  if (name.size() + suffix.size() > 255 && name.size() <= 255) name.resize(255 - suffix.size());
  return target.parent_path() / (name + suffix);
}

// Without this a power cut may undo the rename. A file system that cannot do it has nothing better to offer.
void flush_folder_of(const std::filesystem::path& file) noexcept {
  const std::filesystem::path folder = file.parent_path();
  const FileDescriptor fd(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.is_open()) static_cast<void>(::fsync(fd.get()));
}

}  // namespace

hal::Result<AtomicFile> AtomicFile::create(const std::string& path) {
  if (path.empty()) return hal::fail(hal::ErrorCode::usage, "output file", "has an empty name, expected a file name");
  AtomicFile file;
  file.target_ = path;
  std::error_code ec;
  if (std::filesystem::is_symlink(path, ec)) {
    if (auto behind = std::filesystem::canonical(path, ec); !ec) file.target_ = std::move(behind);
  }
  struct stat status {};
  if (::stat(file.target_.c_str(), &status) != 0) {
    if (path.back() == '/') return tl::unexpected(file_error(EISDIR, path, cannot_write));
    return file.open_partial(std::nullopt).map([&] { return std::move(file); });
  }
  if (S_ISDIR(status.st_mode)) return tl::unexpected(file_error(EISDIR, path, cannot_write));
  if (S_ISREG(status.st_mode)) {
    return file.open_partial(status.st_mode & 07777U).map([&] { return std::move(file); });
  }
  file.replaces_ = false;
  file.partial_ = file.target_;
  file.file_ = FileDescriptor(::open(file.target_.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.file_.is_open()) return tl::unexpected(file_error(errno, path, cannot_write));
  return file;
}

hal::Result<void> AtomicFile::open_partial(std::optional<mode_t> permissions) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    partial_ = partial_name(target_);
    file_ = FileDescriptor(::open(partial_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file_.is_open()) {
      if (permissions) static_cast<void>(::fchmod(file_.get(), *permissions));
      return {};
    }
    // A leftover of a crashed process that had the same number: take the next name.
    if (errno != EEXIST) break;
  }
  return tl::unexpected(file_error(errno, target_, cannot_write));
}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  if (this != &other) {
    discard();
    file_ = std::move(other.file_);
    target_ = std::move(other.target_);
    partial_ = std::move(other.partial_);
    replaces_ = other.replaces_;
  }
  return *this;
}

AtomicFile::~AtomicFile() {
  discard();
}

hal::Result<void> AtomicFile::write(std::span<const std::byte> bytes) {
  const int error_number = write_all(file_.get(), bytes);
  if (error_number != 0) return tl::unexpected(file_error(error_number, target_, cannot_write));
  return {};
}

hal::Result<void> AtomicFile::write(std::string_view text) {
  return write(std::as_bytes(std::span(text.data(), text.size())));
}

hal::Result<void> AtomicFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!replaces_) {
    return hal::fail(hal::ErrorCode::unsupported, target_,
                     "is a device or a pipe, expected a file, because its beginning is written last");
  }
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return tl::unexpected(file_error(errno, target_, cannot_write));
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    offset += static_cast<std::uint64_t>(put);
  }
  return {};
}

hal::Result<void> AtomicFile::truncate(std::uint64_t size) {
  if (!replaces_) {
    return hal::fail(hal::ErrorCode::unsupported, target_, "is a device or a pipe, expected a file");
  }
  if (::ftruncate(file_.get(), static_cast<off_t>(size)) != 0 ||
      ::lseek(file_.get(), static_cast<off_t>(size), SEEK_SET) < 0) {
    return tl::unexpected(file_error(errno, target_, cannot_write));
  }
  return {};
}

hal::Result<void> AtomicFile::commit() {
  if (!file_.is_open()) return hal::fail(hal::ErrorCode::usage, target_, "was already finished or given up");
  int error_number = 0;
  if (replaces_ && ::fsync(file_.get()) != 0) error_number = errno;
  if (error_number != 0) {
    discard();
    return tl::unexpected(file_error(error_number, target_, cannot_write));
  }
  error_number = file_.close();
  if (replaces_ && error_number == 0 && ::rename(partial_.c_str(), target_.c_str()) != 0) error_number = errno;
  if (error_number != 0) {
    if (replaces_) ::unlink(partial_.c_str());
    return tl::unexpected(file_error(error_number, target_, cannot_write));
  }
  if (replaces_) flush_folder_of(target_);
  return {};
}

void AtomicFile::discard() noexcept {
  if (!file_.is_open()) return;
  static_cast<void>(file_.close());
  if (replaces_) ::unlink(partial_.c_str());
}

hal::Result<void> try_output(const std::string& path) {
  if (path.empty()) return {};
  return AtomicFile::create(path).map([](const AtomicFile&) {});
}

hal::Result<void> make_folder(const std::string& folder, std::string_view trouble) {
  std::error_code ec;
  if (!folder.empty()) std::filesystem::create_directories(folder, ec);
  if (ec) return tl::unexpected(file_error(ec.value(), folder, trouble));
  return {};
}

hal::Result<void> write_file_atomically(const std::string& path, std::span<const std::byte> bytes) {
  AtomicFile file = TRY(AtomicFile::create(path));
  TRY(file.write(bytes));
  return file.commit();
}

}  // namespace compueye::firmware
