#include "firmware/files/output_stream.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

namespace compueye::firmware {
namespace {

// What a pipe with any room at all takes whole.
constexpr std::size_t small_piece = 512;
constexpr int look_again_ms = 100;

bool has_room(int fd, int wait_ms) noexcept {
  pollfd ready{fd, POLLOUT, 0};
  return ::poll(&ready, 1, wait_ms) != 0;
}

}  // namespace

OutputStream::OutputStream(int fd) noexcept : fd_(fd) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) return;
  socket_ = S_ISSOCK(status.st_mode);
  const bool pipe_or_terminal = S_ISFIFO(status.st_mode) || ::isatty(fd) == 1;
  may_stall_ = socket_ || pipe_or_terminal;
  if (!pipe_or_terminal) return;
  // O_NONBLOCK belongs to what is open, which the shell has too: setting it on `fd` would upset whatever runs next.
  char name[32];
  std::snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
  own_ = FileDescriptor(::open(name, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
}

ssize_t OutputStream::write_now(std::string_view bytes) noexcept {
  ssize_t put = 0;
  if (own_.is_open()) {
    put = ::write(own_.get(), bytes.data(), bytes.size());
  } else if (socket_) {
    put = ::send(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  } else if (!may_stall_) {
    put = ::write(fd_, bytes.data(), bytes.size());
  } else if (has_room(fd_, 0)) {
    put = ::write(fd_, bytes.data(), std::min(bytes.size(), small_piece));
  }
  if (put >= 0) return put;
  return errno == EAGAIN || errno == EINTR ? 0 : -errno;
}

int OutputStream::write(std::string_view bytes, const std::function<bool()>& go_on) {
  while (!bytes.empty()) {
    const ssize_t put = write_now(bytes);
    if (put < 0) return static_cast<int>(-put);
    bytes.remove_prefix(static_cast<std::size_t>(put));
    if (put > 0) continue;
    if (!go_on()) return ETIMEDOUT;
    static_cast<void>(has_room(own_.is_open() ? own_.get() : fd_, look_again_ms));
  }
  return 0;
}

}  // namespace compueye::firmware
