#include "firmware/files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "firmware/files/output_target.hpp"
#include "firmware/files/partial_file.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

/// What is no file and cannot be replaced. A pipe is opened without waiting for its reader, and written to as usual.
hal::Result<FileDescriptor> open_in_place(const std::string& path) {
  FileDescriptor file(::open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!file.is_open()) return tl::unexpected(file_error(errno, path, cannot_write));
  const int flags = ::fcntl(file.get(), F_GETFL);
  if (flags >= 0) static_cast<void>(::fcntl(file.get(), F_SETFL, flags & ~O_NONBLOCK));
  return file;
}

/// As its owner had it.
void take_after(const FileDescriptor& file, const struct stat& older) noexcept {
  // Root's way to leave a file to its owner; others may at least have the group. Before the mode, which it resets.
  if (::fchown(file.get(), older.st_uid, older.st_gid) != 0) {
    static_cast<void>(::fchown(file.get(), static_cast<uid_t>(-1), older.st_gid) == 0);
  }
  static_cast<void>(::fchmod(file.get(), older.st_mode & 07777U));
}

}  // namespace

void flush_folder_of(const std::string& file) noexcept {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  const FileDescriptor fd(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.is_open()) static_cast<void>(::fsync(fd.get()));
}

hal::Result<AtomicFile> AtomicFile::create(const std::string& path) {
  if (path.empty()) return hal::fail(hal::ErrorCode::usage, "output file", "has an empty name, expected a file name");
  AtomicFile file;
  file.target_ = path;
  file.replaces_ = false;
  if (const auto stream = named_stream(path)) {
    file.file_ = FileDescriptor(::fcntl(*stream, F_DUPFD_CLOEXEC, 0));
    if (!file.file_.is_open()) return tl::unexpected(file_error(errno, path, cannot_write));
    return file;
  }
  const OutputTarget target = TRY(output_target(path));
  file.target_ = target.path;
  if (target.present && !S_ISREG(target.present->st_mode)) {
    file.file_ = TRY(open_in_place(target.path));
    return file;
  }
  PartialFile partial = TRY(PartialFile::create(target.path));
  if (target.present) take_after(partial.file, *target.present);
  file.replaces_ = true;
  file.file_ = std::move(partial.file);
  file.partial_ = std::move(partial.path);
  return file;
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

hal::Result<void> AtomicFile::commit() {
  if (!file_.is_open()) return hal::fail(hal::ErrorCode::usage, target_, "was already finished or given up");
  int error_number = 0;
  if (replaces_ && ::fsync(file_.get()) != 0) error_number = errno;
  if (error_number != 0) {
    discard();
    return tl::unexpected(file_error(error_number, target_, cannot_write));
  }
  if (!replaces_) {
    error_number = file_.close();
    return error_number == 0 ? hal::Result<void>{} : tl::unexpected(file_error(error_number, target_, cannot_write));
  }
  // Still open, and so locked: who sweeps must not find it between the two.
  if (::rename(partial_.c_str(), target_.c_str()) != 0) {
    error_number = errno;
    discard();
    return tl::unexpected(file_error(error_number, target_, cannot_write));
  }
  forget_partial(partial_);
  error_number = file_.close();
  if (error_number != 0) return tl::unexpected(file_error(error_number, target_, cannot_write));
  flush_folder_of(target_);
  return {};
}

void AtomicFile::discard() noexcept {
  if (!file_.is_open()) return;
  if (replaces_) {
    ::unlink(partial_.c_str());
    forget_partial(partial_);
  }
  static_cast<void>(file_.close());
}

hal::Result<void> try_output(const std::string& path) {
  if (path.empty() || named_stream(path)) return {};
  const OutputTarget target = TRY(output_target(path));
  if (!target.present || S_ISREG(target.present->st_mode))
    return AtomicFile::create(path).map([](const AtomicFile&) {});
  // Who reads a pipe would take the end of the trial for the end of the output.
  if (::faccessat(AT_FDCWD, target.path.c_str(), W_OK, AT_EACCESS) == 0) return {};
  return tl::unexpected(file_error(errno, path, cannot_write));
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
