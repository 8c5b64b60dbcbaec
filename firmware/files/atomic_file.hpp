#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "firmware/files/file_descriptor.hpp"
#include "hal/result.hpp"

namespace compueye::firmware {

/// A file that appears whole or not at all.
///
/// Bytes go to "<name>.<process>-<n>.partial" in the same folder; commit() flushes them to the disk and renames the
/// file to its own name, replacing an older one (whose permissions it keeps; through a symbolic link the file behind
/// it is replaced). Without commit() the partial file is removed; after a crash or power cut it stays under its
/// partial name and the old file is untouched. A target that exists and is a device or a pipe (/dev/stdout) cannot be
/// replaced: bytes go straight to it.
///
/// Every error names the target and says what to do: not_found (no such folder), no_space (disk full, quota, file
/// size limit), io (permission, read-only, target is a folder).
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

  /// Overwrites bytes already written, leaving the end where it is. Error unsupported on a device or pipe.
  [[nodiscard]] hal::Result<void> overwrite(std::uint64_t offset, std::span<const std::byte> bytes);

  /// Gives up everything behind `size` bytes. Error unsupported on a device or pipe.
  [[nodiscard]] hal::Result<void> truncate(std::uint64_t size);

  /// Makes the file appear; afterwards nothing more may be written. On failure the partial file is removed.
  [[nodiscard]] hal::Result<void> commit();

  /// Removes the partial file; idempotent, and nothing after commit().
  void discard() noexcept;

  /// Where the bytes are until commit(); the target itself for a device or pipe.
  [[nodiscard]] const std::string& partial_path() const noexcept { return partial_; }
  /// False for a device or a pipe.
  [[nodiscard]] bool replaces() const noexcept { return replaces_; }

 private:
  AtomicFile() = default;
  [[nodiscard]] hal::Result<void> open_partial(std::optional<mode_t> permissions);

  FileDescriptor file_;
  std::string target_;
  std::string partial_;
  bool replaces_ = true;
};

/// Whether a file can be made at `path`, so that it is known before long work and not after it. Nothing stays of the
/// trial; an empty path is no file, and fine. Errors: those of AtomicFile::create().
[[nodiscard]] hal::Result<void> try_output(const std::string& path);

/// Makes a folder, and those it lies in, unless it is there; an empty path is fine. `trouble` is what an error says.
[[nodiscard]] hal::Result<void> make_folder(const std::string& folder, std::string_view trouble = "cannot be made");

/// create, write, commit.
[[nodiscard]] hal::Result<void> write_file_atomically(const std::string& path, std::span<const std::byte> bytes);

}  // namespace compueye::firmware
