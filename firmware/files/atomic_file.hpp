#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "firmware/files/file_descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A file that appears whole or not at all.
///
/// Bytes go to a partial file in the same folder (partial_file.hpp); commit() flushes it to the disk, gives it its own
/// name, replacing an older one (whose permissions and group it keeps; through a symbolic link the file behind it is
/// replaced or made), and flushes the folder. Without commit() the partial file is removed; after a crash or power cut
/// it stays until the next process writes there, and the old file is untouched. A device, a pipe and a stream of this
/// process ("-", /dev/stdout) cannot be replaced: bytes go straight to it.
///
/// Every error names the target and says what to do: those of output_target(); not_found (no such folder), no_space
/// (disk full, quota, file size limit), io (permission, read-only, a pipe that nobody reads).
class AtomicFile {
 public:
  [[nodiscard]] static hal::Result<AtomicFile> create(const std::string& path);

  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  AtomicFile(AtomicFile&&) noexcept = default;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  ~AtomicFile();

  /// Appends; unbuffered.
  [[nodiscard]] hal::Result<void> write(std::span<const std::byte> bytes);
  [[nodiscard]] hal::Result<void> write(std::string_view text);

  /// Makes the file appear; afterwards nothing more may be written. On failure the partial file is removed.
  [[nodiscard]] hal::Result<void> commit();

  /// Removes the partial file; idempotent, and nothing after commit().
  void discard() noexcept;

  /// Where the bytes are until commit(); empty for a device or pipe.
  [[nodiscard]] const std::string& partial_path() const noexcept { return partial_; }
  /// False for a device or a pipe.
  [[nodiscard]] bool replaces() const noexcept { return replaces_; }

 private:
  AtomicFile() = default;

  FileDescriptor file_;
  std::string target_;
  std::string partial_;
  bool replaces_ = true;
};

/// Whether a file can be made at `path`, so that it is known before long work and not after it. Nothing stays of the
/// trial; an empty path is no file, and fine. Errors: those of AtomicFile::create().
[[nodiscard]] hal::Result<void> try_output(const std::string& path);

/// Without this a power cut may undo what was made or renamed in the folder of `file`. A file system that cannot do it
/// has nothing better to offer.
void flush_folder_of(const std::string& file) noexcept;

/// Makes a folder, and those it lies in, unless it is there; an empty path is fine. `trouble` is what an error says.
[[nodiscard]] hal::Result<void> make_folder(const std::string& folder, std::string_view trouble = "cannot be made");

/// create, write, commit.
[[nodiscard]] hal::Result<void> write_file_atomically(const std::string& path, std::span<const std::byte> bytes);

}  // namespace compueye::firmware
