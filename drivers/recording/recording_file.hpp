#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/result.hpp"

namespace compueye::recording {

/// An error of the operating system about `path`: no_space (disk full, quota, file size limit), not_found, timeout,
/// io; the
/// sentence ends with what the system said.
[[nodiscard]] hal::Error file_failure(int error_number, const std::string& path, const char* action);

/// An open file; closes it when it goes away.
class OpenFile {
 public:
  OpenFile() = default;
  explicit OpenFile(int fd) noexcept : fd_(fd) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;
  ~OpenFile();

  [[nodiscard]] int get() const noexcept { return fd_; }
  /// 0, or the errno of close(); idempotent.
  int close() noexcept;

 private:
  int fd_ = -1;
};

/// Bytes at rest that a recording is read from. Their number is that of the moment they were opened.
class StoredBytes {
 public:
  StoredBytes() = default;
  StoredBytes(const StoredBytes&) = delete;
  StoredBytes& operator=(const StoredBytes&) = delete;
  virtual ~StoredBytes() = default;

  /// What errors name: the file.
  [[nodiscard]] virtual const std::string& place() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
  /// Fills `into`, which lies within size(). Allocates on failure only. Error io also when the file was cut meanwhile.
  [[nodiscard]] virtual hal::Result<void> read_at(std::uint64_t offset, std::span<std::byte> into) = 0;
};

/// A regular file. Errors: not_found, io, bad_format (a folder, a pipe or a device).
[[nodiscard]] hal::Result<std::unique_ptr<StoredBytes>> stored_file(const std::string& path);

[[nodiscard]] std::unique_ptr<StoredBytes> stored_memory(std::vector<std::byte> bytes, std::string place);

}  // namespace compueye::recording
