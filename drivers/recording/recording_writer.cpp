#include "drivers/recording/recording_writer.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <utility>

#include "hal/try.hpp"

namespace compueye::recording {
namespace {

using hal::ErrorCode;

constexpr const char* cannot_write = "cannot be written";

/// Without this a power cut may leave no name for what was written. Not every file system can.
void flush_folder_of(const std::string& path) noexcept {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const OpenFile open(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (open.get() >= 0) static_cast<void>(::fsync(open.get()));
}

hal::Result<OpenFile> open_new(const std::string& path, bool& regular) {
  if (path == "-") {
    regular = false;
    OpenFile file(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0));
    if (file.get() < 0) return tl::unexpected(file_failure(errno, path, cannot_write));
    return file;
  }
  OpenFile file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (file.get() >= 0) return file;
  const int why = errno;
  struct stat status {};
  if (why != EEXIST || ::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) {
    return tl::unexpected(file_failure(why, path, cannot_write));
  }
  regular = false;
  // Without O_NONBLOCK the opening of a pipe would wait for its reader.
  file = OpenFile(::open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (file.get() < 0) return tl::unexpected(file_failure(errno, path, cannot_write));
  return file;
}

RecordedBooks books_of(const hal::FrameAccount& account, std::uint64_t index, std::uint64_t unrecorded) noexcept {
  RecordedBooks books{index, unrecorded, {}};
  std::copy(account.dropped.begin(), account.dropped.end(), books.dropped.begin());
  return books;
}

}  // namespace

hal::Result<RecordingWriter> RecordingWriter::create(const std::string& path, const RecordingHeader& header,
                                                     std::int64_t sync_interval_ns) {
  const auto bytes = TRY(serialise(header));
  RecordingWriter writer;
  writer.path_ = path;
  writer.bits_ = header.source.bits;
  writer.channels_ = static_cast<std::size_t>(header.source.channels);
  writer.buffer_.resize(frame_block_bytes(writer.channels_, writer.bits_));
  writer.sync_interval_ns_ = sync_interval_ns;
  auto file = TRY(open_new(path, writer.regular_));
  writer.file_ = std::move(file);
  if (auto written = writer.write(bytes); !written) {
    // Without its header the file would be of no use to anybody.
    writer.discard();
    return tl::unexpected(std::move(written.error()));
  }
  if (writer.regular_) flush_folder_of(path);
  return writer;
}

hal::Result<void> RecordingWriter::write(std::span<const std::byte> bytes) {
  if (failed_) {
    return hal::fail(ErrorCode::io, path_, "nothing more is recorded, since an earlier write failed");
  }
  return put(bytes);
}

hal::Result<void> RecordingWriter::put(std::span<const std::byte> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t taken = ::write(file_.get(), bytes.data() + done, bytes.size() - done);
    int why = taken < 0 ? errno : 0;
    if (why == EINTR) continue;
    if (why == EAGAIN) {
      pollfd room{file_.get(), POLLOUT, 0};
      if (::poll(&room, 1, static_cast<int>(std::chrono::milliseconds(stall_limit).count())) != 0) continue;
      why = ETIMEDOUT;
    }
    if (why != 0) {
      failed_ = true;
      // If even this fails the rest is a torn tail, which readers know.
      if (regular_ && done > 0 && ::ftruncate(file_.get(), static_cast<off_t>(bytes_)) == 0) {
        static_cast<void>(::lseek(file_.get(), static_cast<off_t>(bytes_), SEEK_SET));
      }
      return tl::unexpected(file_failure(why, path_, cannot_write));
    }
    done += static_cast<std::size_t>(taken);
  }
  bytes_ += bytes.size();
  flushed_ = false;
  return {};
}

hal::Result<void> RecordingWriter::append(const hal::SampleBlock& block, std::int64_t arrival_ns,
                                          const hal::FrameAccount& account, std::uint64_t unrecorded) {
  if (block.codes.size() != channels_ || block.valid.size() != channels_ || block.bits != bits_) {
    return hal::fail(ErrorCode::mismatch, path_,
                     "frame " + std::to_string(block.frame) + " has " + std::to_string(block.codes.size()) +
                         " channels of " + std::to_string(block.bits) + " bits, the recording is of " +
                         std::to_string(channels_) + " of " + std::to_string(bits_));
  }
  BlockHead head;
  head.flags = block.flags;
  head.config_id = block.config_id;
  head.frame = block.frame;
  head.t_ns = block.t_ns;
  head.arrival_ns = arrival_ns;
  head.books = books_of(account, frames_, unrecorded);
  if (!follows(head, last_, last_frame_)) {
    return hal::fail(ErrorCode::mismatch, path_,
                     "frame " + std::to_string(block.frame) +
                         " has a number or an account that lies behind that of the frame before");
  }
  if (!encode_frame_block(head, block.codes, block.valid, bits_, buffer_)) {
    return hal::fail(ErrorCode::out_of_range, path_,
                     "frame " + std::to_string(block.frame) + " holds a code above " + std::to_string(bits_) +
                         " bits, or a counter or time that a recording has no room for");
  }
  TRY(write(buffer_));
  ++frames_;
  last_ = head.books;
  ++last_.index;
  last_frame_ = head.frame;
  return flush_if_due(arrival_ns);
}

hal::Result<void> RecordingWriter::flush_if_due(std::int64_t now_ns) {
  if (sync_interval_ns_ <= 0 || flushed_ || failed_ || now_ns - last_sync_ns_ < sync_interval_ns_) return {};
  last_sync_ns_ = now_ns;
  flushed_ = true;
  // Not every file system can flush; a disk that is broken or full says so here.
  if (!regular_ || ::fdatasync(file_.get()) == 0 || errno == EINVAL || errno == EROFS) return {};
  failed_ = true;
  return tl::unexpected(file_failure(errno, path_, "cannot be flushed to the disk"));
}

void RecordingWriter::discard() noexcept {
  failed_ = true;
  static_cast<void>(file_.close());
  if (regular_) ::unlink(path_.c_str());
}

/// Books are worth more than a frame, which is longer.
void RecordingWriter::end_in_place_of_last_frame(BlockHead head) noexcept {
  const std::uint64_t shorter = bytes_ - buffer_.size();
  std::array<std::byte, end_block_bytes> bytes{};
  --head.books.index;
  ++head.books.unrecorded;
  if (!regular_ || frames_ == 0 || !encode_end_block(head, bytes)) return;
  if (::ftruncate(file_.get(), static_cast<off_t>(shorter)) != 0) return;
  if (::lseek(file_.get(), static_cast<off_t>(shorter), SEEK_SET) < 0) return;
  bytes_ = shorter;
  --frames_;
  static_cast<void>(put(bytes));
}

hal::Result<void> RecordingWriter::finish(Ending ending, std::int64_t at_ns, const hal::FrameAccount& account,
                                          std::uint64_t unrecorded) {
  BlockHead head;
  head.kind = BlockKind::end;
  head.ending = ending;
  head.arrival_ns = std::clamp(at_ns, std::int64_t{0}, most_arrival_ns);
  head.books = books_of(account, frames_, unrecorded);
  head.books.estimated = account.estimated;
  const bool failed_before = failed_;
  hal::Result<void> done;
  std::array<std::byte, end_block_bytes> bytes{};
  if (!encode_end_block(head, bytes)) {
    done = hal::fail(ErrorCode::out_of_range, path_,
                     "the source's account holds a counter that a recording has no room for");
  } else if (!failed_ || regular_) {
    // After a failure, too: what says how many frames are missing is small, and somebody may have made room.
    done = put(bytes);
    if (!done && done.error().code == ErrorCode::no_space) end_in_place_of_last_frame(head);
  }
  if (failed_before) done = {};
  if (regular_ && ::fsync(file_.get()) != 0 && errno != EINVAL && errno != EROFS && done) {
    done = tl::unexpected(file_failure(errno, path_, "cannot be flushed to the disk"));
  }
  if (const int why = file_.close(); why != 0 && done) done = tl::unexpected(file_failure(why, path_, cannot_write));
  return done;
}

}  // namespace compueye::recording
