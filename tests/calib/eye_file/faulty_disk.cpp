#include "tests/calib/eye_file/faulty_disk.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace compueye::calib::tests {
namespace {

constexpr std::size_t sector = 512;

std::vector<unsigned char> content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void apply(const DiskFile::Change& change, std::vector<unsigned char>& to) {
  const auto offset = static_cast<std::size_t>(change.offset);
  if (change.bytes.empty()) {
    to.resize(std::min(offset, to.size()));
    return;
  }
  if (to.size() < offset + change.bytes.size()) to.resize(offset + change.bytes.size());
  std::copy(change.bytes.begin(), change.bytes.end(), to.begin() + change.offset);
}

struct Draws {
  std::uint64_t state;
  std::uint64_t next(std::uint64_t below) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return (state >> 33U) % below;
  }
};

/// What is left of a change that was under way: sectors of it, some of them torn.
void apply_in_part(const DiskFile::Change& change, std::vector<unsigned char>& to, Draws& draws) {
  if (change.bytes.empty()) {
    if (draws.next(2) == 0) apply(change, to);
    return;
  }
  std::size_t done = 0;
  while (done < change.bytes.size()) {
    const std::size_t at = static_cast<std::size_t>(change.offset) + done;
    const std::size_t piece = std::min(sector - at % sector, change.bytes.size() - done);
    const std::uint64_t fate = draws.next(8);
    const std::size_t kept = fate < 4 ? 0 : fate < 7 ? piece : draws.next(piece);
    if (kept > 0) {
      const auto begin = change.bytes.begin() + static_cast<std::ptrdiff_t>(done);
      apply({static_cast<std::int64_t>(at), {begin, begin + static_cast<std::ptrdiff_t>(kept)}}, to);
    }
    done += piece;
  }
}

/// A file as SQLite sees it; the real one follows it in memory.
struct OpenFile {
  sqlite3_file base;
  sqlite3_file* real;
  FaultyDisk* disk;
  DiskFile* file;  // null: a temporary one, of no interest
};

OpenFile& of(sqlite3_file* file) {
  return *reinterpret_cast<OpenFile*>(file);
}

}  // namespace

/// What SQLite calls; the names are those of sqlite3_io_methods and sqlite3_vfs.
struct FaultyDiskCalls {
  static int write(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 offset) {
    auto& [base, real, disk, stored] = of(file);
    if (!disk->counts()) return SQLITE_IOERR_WRITE;
    if (disk->full_after >= 0 && (disk->full_after -= count) < 0) {
      disk->full_after = 0;
      return SQLITE_FULL;
    }
    if (stored != nullptr) {
      const auto* begin = static_cast<const unsigned char*>(bytes);
      stored->unsynced.push_back({offset, {begin, begin + count}});
    }
    return real->pMethods->xWrite(real, bytes, count, offset);
  }
  static int truncate(sqlite3_file* file, sqlite3_int64 size) {
    auto& [base, real, disk, stored] = of(file);
    if (!disk->counts()) return SQLITE_IOERR_TRUNCATE;
    if (stored != nullptr) stored->unsynced.push_back({size, {}});
    return real->pMethods->xTruncate(real, size);
  }
  static int sync(sqlite3_file* file, int) {
    auto& [base, real, disk, stored] = of(file);
    if (!disk->counts()) return SQLITE_IOERR_FSYNC;
    ++disk->syncs_;
    if (stored == nullptr) return SQLITE_OK;
    for (const DiskFile::Change& change : std::exchange(stored->unsynced, {})) apply(change, stored->durable);
    stored->exists = true;  // SQLite's own syncs the folder with a journal or log that is new
    return SQLITE_OK;
  }
  static int close(sqlite3_file* file) { return of(file).real->pMethods->xClose(of(file).real); }
  static int read(sqlite3_file* file, void* to, int count, sqlite3_int64 offset) {
    if (of(file).disk->off_) return SQLITE_IOERR_READ;
    return of(file).real->pMethods->xRead(of(file).real, to, count, offset);
  }
  static int file_size(sqlite3_file* file, sqlite3_int64* size) {
    return of(file).real->pMethods->xFileSize(of(file).real, size);
  }
  static int lock(sqlite3_file* file, int level) { return of(file).real->pMethods->xLock(of(file).real, level); }
  static int unlock(sqlite3_file* file, int level) { return of(file).real->pMethods->xUnlock(of(file).real, level); }
  static int check_lock(sqlite3_file* file, int* held) {
    return of(file).real->pMethods->xCheckReservedLock(of(file).real, held);
  }
  static int control(sqlite3_file* file, int what, void* argument) {
    return of(file).real->pMethods->xFileControl(of(file).real, what, argument);
  }
  static int sector_size(sqlite3_file* file) { return of(file).real->pMethods->xSectorSize(of(file).real); }
  static int device(sqlite3_file* file) { return of(file).real->pMethods->xDeviceCharacteristics(of(file).real); }

  static int open(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* out_flags) {
    static constexpr sqlite3_io_methods methods{1,       close,   read,       write,   truncate,    sync,   file_size,
                                                lock,    unlock,  check_lock, control, sector_size, device, nullptr,
                                                nullptr, nullptr, nullptr,    nullptr, nullptr};
    auto* disk = static_cast<FaultyDisk*>(vfs->pAppData);
    OpenFile& opened = of(file);
    opened = {{nullptr}, reinterpret_cast<sqlite3_file*>(&opened + 1), disk, nullptr};
    if (disk->off_) return SQLITE_CANTOPEN;
    const bool ours =
        name != nullptr && (flags & (SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_WAL)) != 0;
    if (disk->read_only) flags = (flags & ~(SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE)) | SQLITE_OPEN_READONLY;
    if (ours) opened.file = &disk->known(name);
    const int code = disk->below_->xOpen(disk->below_, name, opened.real, flags, out_flags);
    if (code == SQLITE_OK) opened.base.pMethods = &methods;
    return code;
  }
  static int remove(sqlite3_vfs* vfs, const char* name, int sync_folder) {
    auto* disk = static_cast<FaultyDisk*>(vfs->pAppData);
    if (!disk->counts()) return SQLITE_IOERR_DELETE;
    DiskFile& file = disk->known(name);
    if (sync_folder != 0) file = {};
    return disk->below_->xDelete(disk->below_, name, 0);
  }
  static int access(sqlite3_vfs* vfs, const char* name, int flags, int* result) {
    auto* disk = static_cast<FaultyDisk*>(vfs->pAppData);
    return disk->below_->xAccess(disk->below_, name, flags, result);
  }
  static int full_name(sqlite3_vfs* vfs, const char* name, int size, char* out) {
    auto* disk = static_cast<FaultyDisk*>(vfs->pAppData);
    return disk->below_->xFullPathname(disk->below_, name, size, out);
  }
};

FaultyDisk::FaultyDisk() : below_(sqlite3_vfs_find(nullptr)) {
  vfs_ = *below_;  // time, randomness and the like
  vfs_.zName = "faulty-disk";
  vfs_.pNext = nullptr;
  vfs_.pAppData = this;
  vfs_.szOsFile = static_cast<int>(sizeof(OpenFile)) + below_->szOsFile;
  vfs_.xOpen = FaultyDiskCalls::open;
  vfs_.xDelete = FaultyDiskCalls::remove;
  vfs_.xAccess = FaultyDiskCalls::access;
  vfs_.xFullPathname = FaultyDiskCalls::full_name;
  sqlite3_vfs_register(&vfs_, 1);
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_unregister(&vfs_);
  sqlite3_vfs_register(below_, 1);
}

bool FaultyDisk::counts() noexcept {
  off_ = off_ || operations_ == cut_before;
  if (!off_) ++operations_;
  return !off_;
}

DiskFile& FaultyDisk::known(const std::string& path) {
  const auto [found, is_new] = files_.try_emplace(path);
  if (is_new && std::filesystem::exists(path)) found->second = {true, content_of(path), {}};
  return found->second;
}

void FaultyDisk::power_comes_back(std::uint64_t seed) {
  Draws draws{seed};
  for (auto& [path, file] : files_) {
    const bool was_there = std::filesystem::exists(path);
    for (const DiskFile::Change& change : file.unsynced) apply_in_part(change, file.durable, draws);
    const bool sure = was_there && file.exists;
    std::filesystem::remove(path);
    if ((!was_there && !file.exists) || (!sure && draws.next(2) == 0)) continue;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.durable.data()), static_cast<std::streamsize>(file.durable.size()));
  }
  files_.clear();
  off_ = false;
  cut_before = -1;
}

}  // namespace compueye::calib::tests
