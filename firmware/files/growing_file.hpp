#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "firmware/files/file_descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A file that is of use while it grows, under its own name from the start: whatever ends the process leaves what was
/// appended until then.
///
/// Every error names the file and says what to do: those of file_error(); io when there is a file or a link of that
/// name already, which is never overwritten.
class GrowingFile {
 public:
  [[nodiscard]] static hal::Result<GrowingFile> create(const std::string& path);

  /// All of it or nothing: what is written in part is cut off again. Allocates on failure only.
  [[nodiscard]] hal::Result<void> append(std::span<const std::byte> bytes);
  /// Bytes that are there already.
  [[nodiscard]] hal::Result<void> overwrite(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Flushes the file and its folder to the disk.
  [[nodiscard]] hal::Result<void> close();

 private:
  std::string path_;
  FileDescriptor file_;
  std::uint64_t size_ = 0;
};

}  // namespace compueye::firmware
