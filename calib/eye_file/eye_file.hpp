#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/eye_file/eye_records.hpp"
#include "calib/eye_file/record_digest.hpp"
#include "hal/result.hpp"

namespace compueye::calib {

class Database;
class EyeFile;

enum class EyeFileMode { read, write };

/// The captures of a session in the order they were taken, one at a time. The EyeFile outlives it.
class CaptureReader {
 public:
  /// Nothing: there are no more. Errors: bad_format (a hash that does not match, a gap, fewer than the session ended
  /// with), and those of the file.
  [[nodiscard]] hal::Result<std::optional<Capture>> next();

 private:
  friend class EyeFile;
  CaptureReader(const EyeFile& file, StoredSession session) : file_(&file), session_(std::move(session)) {}
  [[nodiscard]] hal::Result<void> check_end() const;

  const EyeFile* file_;
  StoredSession session_;
  std::int64_t position_ = 0;
  RecordDigest raw_{raw_data};
};

/// The file of an eye (*.eye, SQLite, schema.sql): its geometry, the captures of its calibration sessions and the
/// responses that were estimated from them.
///
/// Whatever ends the process or the power, what a call has stored is stored, and what it has not is not there at all:
/// write-ahead log with synchronous = FULL while the file is open for writing, a single file without it once it is
/// closed. One writer at a time, and no reader beside it: the lock is held until close(). Many readers.
///
/// Every error names the file in one sentence: not_found; io (a folder, no permission, read-only, in use by another
/// process, the disk); no_space; unsupported (written by a newer program); bad_format (no eye file, cut short,
/// damaged, or a record whose hash does not match); mismatch and out_of_range (what is to be stored makes no sense).
/// A call that failed has changed nothing, and may be made again.
class EyeFile {
 public:
  /// There must be nothing at `path`, or a file with nothing in it, as a creation that was cut off leaves; opens it for
  /// writing.
  [[nodiscard]] static hal::Result<EyeFile> create(const std::string& path, const EyeIdentity& eye);
  [[nodiscard]] static hal::Result<EyeFile> open(const std::string& path, EyeFileMode mode);
  EyeFile(EyeFile&&) noexcept;
  EyeFile& operator=(EyeFile&&) noexcept;
  ~EyeFile();  ///< close(), whatever comes of it

  /// Makes one file of it and lets go of the lock. Where that fails all is stored nevertheless, in a file beside it.
  [[nodiscard]] hal::Result<void> close();

  [[nodiscard]] const EyeIdentity& eye() const noexcept { return eye_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// The new session's id.
  [[nodiscard]] hal::Result<std::int64_t> begin_session(const Session& session);
  /// On the disk when it returns: its position in the session. Error usage: the session has ended.
  [[nodiscard]] hal::Result<std::int64_t> append_capture(std::int64_t session, const Capture& capture);
  /// No capture follows.
  [[nodiscard]] hal::Result<void> end_session(std::int64_t session);

  /// By id.
  [[nodiscard]] hal::Result<std::vector<StoredSession>> sessions() const;
  [[nodiscard]] hal::Result<std::int64_t> capture_count(std::int64_t session) const;
  /// Error not_found: there is no such session.
  [[nodiscard]] hal::Result<CaptureReader> captures(std::int64_t session) const;
  /// Hash over the hashes of all captures of these sessions: the same as long as the raw data are.
  [[nodiscard]] hal::Result<std::uint64_t> raw_hash(std::span<const std::int64_t> sessions) const;

  /// All of it or nothing: its id. Entries are rounded to float32; `sigma`: one per stored entry, or none at all.
  [[nodiscard]] hal::Result<std::int64_t> store_estimate(const Estimate& estimate, const recon::Response& response,
                                                         std::span<const float> sigma);
  /// By id, so that the newest is the last.
  [[nodiscard]] hal::Result<std::vector<StoredEstimate>> estimates() const;
  /// Error not_found: there is no such estimate.
  [[nodiscard]] hal::Result<Estimate> load_estimate(std::int64_t estimate) const;
  [[nodiscard]] hal::Result<MeasuredResponse> load_response(std::int64_t estimate) const;

 private:
  friend class CaptureReader;
  EyeFile(std::string path, EyeFileMode mode, std::unique_ptr<Database> database);
  [[nodiscard]] hal::Result<void> begin_log();
  [[nodiscard]] hal::Result<void> check_writable() const;
  [[nodiscard]] hal::Result<void> check_open() const;

  std::string path_;
  EyeFileMode mode_ = EyeFileMode::read;
  EyeIdentity eye_;
  bool has_log_ = false;
  std::unique_ptr<Database> database_;
};

}  // namespace compueye::calib
