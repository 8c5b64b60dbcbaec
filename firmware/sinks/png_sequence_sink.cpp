#include "firmware/sinks/png_sequence_sink.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <utility>

#include "firmware/files/atomic_file.hpp"
#include "firmware/files/file_descriptor.hpp"
#include "hal/try.hpp"

namespace compueye::firmware {
namespace {

// "/frame-" with up to 20 digits, ".png.partial" and the end.
constexpr std::size_t longest_suffix = 7 + 20 + 12 + 1;

void print_name(std::string& into, const std::string& folder, std::uint64_t frame, const char* end) {
  std::snprintf(into.data(), into.size(), "%s/frame-%06" PRIu64 "%s", folder.c_str(), frame, end);
}

/// Never what is there already: a link that was planted would lead the picture elsewhere.
FileDescriptor open_partial(const char* partial) noexcept {
  constexpr int how = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  const int fd = ::open(partial, how, 0666);
  if (fd >= 0 || errno != EEXIST || ::unlink(partial) != 0) return FileDescriptor(fd);
  return FileDescriptor(::open(partial, how, 0666));
}

// 0 or an errno; leaves nothing behind on failure.
int write_and_rename(const char* partial, const char* name, std::span<const std::byte> bytes) noexcept {
  FileDescriptor file = open_partial(partial);
  if (!file.is_open()) return errno;
  int error_number = write_all(file.get(), bytes);
  const int close_error = file.close();
  if (error_number == 0) error_number = close_error;
  if (error_number == 0 && ::rename(partial, name) != 0) error_number = errno;
  if (error_number != 0) ::unlink(partial);
  return error_number;
}

}  // namespace

PngSequenceSink::~PngSequenceSink() {
  static_cast<void>(PngSequenceSink::close());
}

hal::Result<void> PngSequenceSink::open(hal::FrameFormat format) {
  if (encoder_) return hal::fail(hal::ErrorCode::usage, folder_, "is already open, expected a close() first");
  if (bits_ != 8 && bits_ != 16) {
    return hal::fail(hal::ErrorCode::usage, folder_,
                     "was to get PNGs of " + std::to_string(bits_) + " bits, expected 8 or 16");
  }
  PngEncoder encoder =
      TRY(PngEncoder::create(format.rows, format.cols, bits_ == 8 ? PngFormat::grey8 : PngFormat::grey16));
  name_.assign(folder_.size() + longest_suffix, '\0');
  partial_.assign(folder_.size() + longest_suffix, '\0');
  TRY(try_folder());
  format_ = format;
  encoder_.emplace(std::move(encoder));
  return {};
}

hal::Result<void> PngSequenceSink::try_folder() {
  TRY(make_folder(folder_));
  print_name(partial_, folder_, 0, ".png.partial");
  const FileDescriptor probe = open_partial(partial_.c_str());
  if (!probe.is_open()) return tl::unexpected(file_error(errno, folder_, "cannot take pictures"));
  ::unlink(partial_.c_str());
  return {};
}

hal::Result<void> PngSequenceSink::write(const hal::Frame& frame) {
  if (!encoder_) return hal::fail(hal::ErrorCode::usage, folder_, "is not open, expected an open() first");
  const std::size_t pixels = static_cast<std::size_t>(format_.rows) * static_cast<std::size_t>(format_.cols);
  if (frame.pixels.size() != pixels) {
    return hal::fail(hal::ErrorCode::usage, folder_,
                     "was given a picture of " + std::to_string(frame.pixels.size()) + " pixels, expected " +
                         std::to_string(pixels));
  }
  encoder_->set_grey(frame.pixels);
  const auto bytes = TRY(encoder_->encode());
  print_name(partial_, folder_, frame.frame, ".png.partial");
  print_name(name_, folder_, frame.frame, ".png");
  const int error_number = write_and_rename(partial_.c_str(), name_.c_str(), bytes);
  if (error_number != 0) return tl::unexpected(file_error(error_number, name_.c_str(), "cannot be written"));
  return {};
}

hal::Result<void> PngSequenceSink::close() {
  if (!encoder_) return {};
  encoder_.reset();
  const FileDescriptor folder(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // One call for all the pictures; a file system that cannot do it has nothing better.
  if (folder.is_open() && ::syncfs(folder.get()) != 0 && errno != ENOSYS) {
    return tl::unexpected(file_error(errno, folder_, "cannot be flushed to the disk"));
  }
  return {};
}

}  // namespace compueye::firmware
