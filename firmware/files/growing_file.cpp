#include "firmware/files/growing_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

#include "firmware/files/atomic_file.hpp"

namespace compueye::firmware {
namespace {}  // namespace

hal::Result<GrowingFile> GrowingFile::create(const std::string& path) {
  GrowingFile made;
  made.path_ = path;
  made.file_ = FileDescriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!made.file_.is_open()) return tl::unexpected(file_error(errno, path, cannot_write));
  return made;
}

hal::Result<void> GrowingFile::append(std::span<const std::byte> bytes) {
  const int why = write_all(file_.get(), bytes);
  if (why == 0) {
    size_ += bytes.size();
    return {};
  }
  // If even this fails what follows is torn, which the size in a header tells.
  if (::ftruncate(file_.get(), static_cast<off_t>(size_)) == 0) {
    static_cast<void>(::lseek(file_.get(), static_cast<off_t>(size_), SEEK_SET));
  }
  return tl::unexpected(file_error(why, path_, cannot_write));
}

hal::Result<void> GrowingFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return tl::unexpected(file_error(errno, path_, cannot_write));
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    offset += static_cast<std::uint64_t>(put);
  }
  return {};
}

hal::Result<void> GrowingFile::close() {
  int why = ::fsync(file_.get()) == 0 ? 0 : errno;
  const int at_end = file_.close();
  if (why == 0) why = at_end;
  if (why != 0) return tl::unexpected(file_error(why, path_, cannot_write));
  flush_folder_of(path_);
  return {};
}

}  // namespace compueye::firmware
