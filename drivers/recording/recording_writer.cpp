#include "drivers/recording/recording_writer.hpp"

#include <fcntl.h>
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

hal::Result<OpenFile> open_new(const std::string& path, bool& regular) {
  OpenFile file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  struct stat status {};
  if (file.get() < 0 && errno == EEXIST && ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    regular = false;
    file = OpenFile(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  }
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
    if (writer.regular_) ::unlink(path.c_str());
    return tl::unexpected(std::move(written.error()));
  }
  return writer;
}

hal::Result<void> RecordingWriter::write(std::span<const std::byte> bytes) {
  if (failed_) {
    return hal::fail(ErrorCode::io, path_, "nothing more is recorded, since an earlier write failed");
  }
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put = ::write(file_.get(), bytes.data() + done, bytes.size() - done);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      const int why = errno;
      failed_ = true;
      // If even this fails the rest is a torn tail, which readers know.
      if (regular_ && done > 0) static_cast<void>(::ftruncate(file_.get(), static_cast<off_t>(bytes_)) == 0);
      return tl::unexpected(file_failure(why, path_, cannot_write));
    }
    done += static_cast<std::size_t>(put);
  }
  bytes_ += bytes.size();
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
  if (sync_interval_ns_ > 0 && arrival_ns - last_sync_ns_ >= sync_interval_ns_) {
    last_sync_ns_ = arrival_ns;
    // Not every file system can flush; a disk that is broken or full says so here.
    if (regular_ && ::fdatasync(file_.get()) != 0 && errno != EINVAL && errno != EROFS) {
      failed_ = true;
      return tl::unexpected(file_failure(errno, path_, "cannot be flushed to the disk"));
    }
  }
  return {};
}

hal::Result<void> RecordingWriter::finish(Ending ending, std::int64_t at_ns, const hal::FrameAccount& account,
                                          std::uint64_t unrecorded) {
  BlockHead head;
  head.kind = BlockKind::end;
  head.ending = ending;
  head.arrival_ns = std::clamp(at_ns, std::int64_t{0}, most_arrival_ns);
  head.books = books_of(account, frames_, unrecorded);
  hal::Result<void> done;
  std::array<std::byte, end_block_bytes> bytes{};
  if (!failed_) {
    if (encode_end_block(head, bytes)) {
      done = write(bytes);
    } else {
      done = hal::fail(ErrorCode::out_of_range, path_,
                       "the source's account holds a counter that a recording has no room for");
    }
  }
  if (regular_ && ::fsync(file_.get()) != 0 && errno != EINVAL && errno != EROFS && done) {
    done = tl::unexpected(file_failure(errno, path_, "cannot be flushed to the disk"));
  }
  if (const int why = file_.close(); why != 0 && done) done = tl::unexpected(file_failure(why, path_, cannot_write));
  return done;
}

}  // namespace compueye::recording
