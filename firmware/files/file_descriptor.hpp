#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "hal/result.hpp"

namespace compueye::firmware {

/// What file_error() says of a file that was to be written.
inline constexpr std::string_view cannot_write = "cannot be written";

/// Turns an errno into an Error whose place is `path` and whose sentence says what could not be done (`action`, for
/// example cannot_write), why, and what to do about it. Codes: not_found, no_space (full disk, quota, size
/// limit), otherwise io.
[[nodiscard]] hal::Error file_error(int error_number, const std::string& path, std::string_view action);

/// The result of making something out of a file, or for one: what is wrong with it is said of the file.
template <class T>
[[nodiscard]] hal::Result<T> placed(hal::Result<T> result, const std::string& path) {
  if (!result) result.error().place = path;
  return result;
}

/// Owns an open file; closes it when it goes away.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) noexcept : fd_(fd) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  FileDescriptor(FileDescriptor&& other) noexcept;
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  ~FileDescriptor();

  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] bool is_open() const noexcept { return fd_ >= 0; }
  /// 0, or the errno of close(): on network file systems a full disk may only be noticed here.
  int close() noexcept;

 private:
  int fd_ = -1;
};

/// Opens for reading. Errors: not_found, io (a folder, no permission).
[[nodiscard]] hal::Result<FileDescriptor> open_for_reading(const std::string& path);

/// Opens for reading what is believed without being made again: a regular file under its own name, not behind a link,
/// that nobody but this user and root can have written. Errors: stale, which says why not; not_found, io.
[[nodiscard]] hal::Result<FileDescriptor> open_own(const std::string& path);
/// Takes away what open_own() refuses: a file in its place would inherit its owner and permissions, or be written
/// through a link to somewhere else. A folder stays.
void remove_unless_own(const std::string& path);

/// Size in bytes of a regular file; nothing for a pipe or a device, whose end is only known once it is reached.
[[nodiscard]] std::optional<std::uint64_t> regular_size(const FileDescriptor& file) noexcept;

/// Fills `into` as far as the file goes; returns the bytes read, fewer only at the end of the file.
[[nodiscard]] hal::Result<std::size_t> read_some(const FileDescriptor& file, const std::string& path,
                                                 std::span<std::byte> into);

/// Writes everything, or returns the errno that stopped it. Neither allocates nor throws.
[[nodiscard]] int write_all(int fd, std::span<const std::byte> bytes) noexcept;

/// Says of the first `first_piece_bytes` of a file (fewer where it ends before) whether the rest is worth reading.
using AcceptBegin = std::function<hal::Result<void>(std::string_view begin)>;
inline constexpr std::size_t first_piece_bytes = 1024;

/// The whole file. A file larger than `max_bytes` is refused with no_space before it is read; one whose begin is not
/// accepted, with the error that `accept` gives, before the rest is.
[[nodiscard]] hal::Result<std::string> read_whole_file(const std::string& path, std::uint64_t max_bytes,
                                                       const AcceptBegin& accept = {});

}  // namespace compueye::firmware
