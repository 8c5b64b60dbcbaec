#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace compueye::calib::tests {

/// What of one file has reached the platter.
struct DiskFile {
  struct Change {
    std::int64_t offset = 0;           ///< of a write
    std::vector<unsigned char> bytes;  ///< empty: the file is cut to `offset`
  };
  bool exists = false;  ///< its name has reached the platter
  std::vector<unsigned char> durable;
  std::vector<Change> unsynced;
};

/// The file system below SQLite, while it lives the default one: SQLite's own, which forgets, on a power cut, what was
/// not synced. A sector of 512 bytes that was on its way is there or not, each for itself, or the first part of it is;
/// a deleted or new name that no sync has made durable may be there or not. What is synced is not really flushed, so a
/// test costs no time of a disk. It gives a file no shared memory.
class FaultyDisk {
 public:
  FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;
  ~FaultyDisk();

  std::int64_t cut_before = -1;  ///< the power fails before this operation; -1: never
  std::int64_t full_after = -1;  ///< bytes that are free; -1: more than enough
  bool read_only = false;

  /// Writes, cuts, syncs, deletions so far.
  [[nodiscard]] std::int64_t operations() const noexcept { return operations_; }
  [[nodiscard]] std::int64_t syncs() const noexcept { return syncs_; }
  [[nodiscard]] bool is_off() const noexcept { return off_; }

  /// The power fails now, and comes back: leaves in the folder what a disk would have left, one way of many, which the
  /// seed chooses. Every file is closed before.
  void power_comes_back(std::uint64_t seed);

 private:
  friend struct FaultyDiskCalls;
  [[nodiscard]] bool counts() noexcept;  // false: the power is off
  DiskFile& known(const std::string& path);

  sqlite3_vfs vfs_{};
  sqlite3_vfs* below_ = nullptr;
  std::map<std::string, DiskFile> files_;
  std::int64_t operations_ = 0, syncs_ = 0;
  bool off_ = false;
};

}  // namespace compueye::calib::tests
