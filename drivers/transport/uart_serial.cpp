#include "drivers/transport/uart_serial.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "drivers/protocol/crc32c.hpp"
#include "drivers/protocol/frame_header.hpp"
#include "drivers/protocol/little_endian.hpp"
#include "hal/clock.hpp"
#include "hal/try.hpp"

namespace compueye::transport {
namespace {

using hal::ErrorCode;

constexpr std::size_t most_kept_bytes = 1U << 20U;
constexpr std::size_t most_frame_bytes = protocol::least_packet_bytes + protocol::most_payload_bytes;
constexpr std::size_t reply_head_bytes = 2;  // request, StatusError

struct Rate {
  int baud;
  speed_t speed;
};
constexpr std::array<Rate, 9> rates{{{9600, B9600},
                                     {19200, B19200},
                                     {38400, B38400},
                                     {57600, B57600},
                                     {115200, B115200},
                                     {230400, B230400},
                                     {460800, B460800},
                                     {921600, B921600},
                                     {3000000, B3000000}}};

}  // namespace

UartTransport::UartTransport(std::string path, int baud) : baud_(baud), chunk_(4096), decoder_(most_frame_bytes) {
  description_.bus = std::move(path);
}

UartTransport::UartTransport(int file, std::string name)
    : file_(file), given_(true), chunk_(4096), decoder_(most_frame_bytes) {
  description_.bus = std::move(name);
}

UartTransport::~UartTransport() {
  given_ = false;
  close();
}

hal::Error UartTransport::failure(int error, const char* doing) const {
  const bool gone = error == EIO || error == ENXIO || error == EPIPE || error == ECONNRESET;
  const ErrorCode code = error == ENOENT ? ErrorCode::not_found : gone ? ErrorCode::disconnected : ErrorCode::io;
  return {code, description_.bus,
          std::string("cannot be ") + doing + ": " + std::generic_category().message(error) +
              (error == EACCES ? "; join the group of the file, or ask who may" : "")};
}

hal::Result<void> UartTransport::set_up_terminal() const {
  const auto* const rate = std::find_if(rates.begin(), rates.end(), [&](const Rate& r) { return r.baud == baud_; });
  if (rate == rates.end()) {
    return hal::fail(ErrorCode::usage, description_.bus,
                     "is asked for " + std::to_string(baud_) +
                         " bits a second, expected 9600 times 1, 2, 4, 6, 12, 24, "
                         "48 or 96, or 3000000");
  }
  termios settings{};
  if (::tcgetattr(file_, &settings) != 0) return tl::unexpected(failure(errno, "set up"));
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  ::cfsetispeed(&settings, rate->speed);
  ::cfsetospeed(&settings, rate->speed);
  if (::tcsetattr(file_, TCSANOW, &settings) != 0) return tl::unexpected(failure(errno, "set up"));
  static_cast<void>(::tcflush(file_, TCIOFLUSH));
  return {};
}

hal::Result<void> UartTransport::open() {
  packets_.clear();
  if (given_) return {};
  close();
  file_ = ::open(description_.bus.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) return tl::unexpected(failure(errno, "opened"));
  // Before the first byte: requests would overwrite a file, and other devices never stop answering.
  if (::isatty(file_) == 0) {
    close();
    return hal::fail(ErrorCode::usage, description_.bus, "is no serial port and no pseudo-terminal");
  }
  return set_up_terminal();
}

void UartTransport::close() noexcept {
  if (given_ || file_ < 0) return;
  ::close(std::exchange(file_, -1));
}

hal::Result<void> UartTransport::wait_for(short events, std::int64_t deadline_ns) const {
  const std::int64_t left_ns = deadline_ns - hal::MonotonicClock().now_ns();
  const auto left_ms = std::clamp<std::int64_t>((left_ns + 999'999) / 1'000'000, 0, std::numeric_limits<int>::max());
  pollfd waiting{file_, events, 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>(left_ms));
  if (ready < 0 && errno != EINTR) return tl::unexpected(failure(errno, "waited for"));
  if (ready <= 0) return hal::timed_out();
  return {};
}

hal::Result<void> UartTransport::send_frame(std::span<const std::byte> frame, std::int64_t deadline_ns) {
  std::vector<std::byte> encoded(protocol::cobs_bytes(frame.size()) + 1);
  const std::size_t length = protocol::cobs_encode(frame, encoded);
  encoded.resize(length + 1);
  encoded[length] = std::byte{0};
  for (std::span<const std::byte> rest = encoded; !rest.empty();) {
    TRY(wait_for(POLLOUT, deadline_ns));
    // A socket whose other end is gone would end the process with a signal.
    ssize_t put = ::send(file_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (put < 0 && errno == ENOTSOCK) put = ::write(file_, rest.data(), rest.size());
    if (put < 0 && errno != EAGAIN && errno != EINTR) return tl::unexpected(failure(errno, "written to"));
    rest = rest.subspan(static_cast<std::size_t>(std::max<ssize_t>(put, 0)));
  }
  return {};
}

hal::Result<void> UartTransport::take_more(std::int64_t deadline_ns) {
  if (file_ < 0) return hal::fail(ErrorCode::usage, description_.bus, "is not open; call open() first");
  TRY(wait_for(POLLIN, deadline_ns));
  const ssize_t got = ::read(file_, chunk_.data(), chunk_.size());
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return {};
  if (got < 0) return tl::unexpected(failure(errno, "read"));
  if (got == 0) return hal::fail(ErrorCode::disconnected, description_.bus, "has ended; is the eye powered?");
  decoder_.feed(std::span<const std::byte>(chunk_).first(static_cast<std::size_t>(got)));
  while (const auto frame = decoder_.next()) {
    if (frame->empty()) continue;
    // What begins as a packet does is one, and no request has that number.
    if (frame->front() != std::byte{protocol::packet_magic & 0xFFU}) {
      reply_.assign(frame->begin(), frame->end());
    } else if (packets_.size() + frame->size() <= most_kept_bytes) {
      packets_.insert(packets_.end(), frame->begin(), frame->end());
    }
  }
  return {};
}

hal::Result<std::size_t> UartTransport::read(std::span<std::byte> into, std::int64_t deadline_ns) {
  while (packets_.empty()) TRY(take_more(deadline_ns));
  const std::size_t bytes = std::min(into.size(), packets_.size());
  std::copy_n(packets_.begin(), bytes, into.begin());
  packets_.erase(packets_.begin(), packets_.begin() + static_cast<std::ptrdiff_t>(bytes));
  return bytes;
}

hal::Result<std::size_t> UartTransport::control(std::uint8_t request, std::span<const std::byte> payload,
                                                std::span<std::byte> reply, std::int64_t deadline_ns) {
  if (file_ < 0) return hal::fail(ErrorCode::usage, description_.bus, "is not open; call open() first");
  std::vector<std::byte> frame{static_cast<std::byte>(request)};
  frame.insert(frame.end(), payload.begin(), payload.end());
  const std::uint32_t crc = protocol::crc32c(frame);
  frame.resize(frame.size() + protocol::packet_crc_bytes);
  protocol::store_little(frame.data() + frame.size() - protocol::packet_crc_bytes, crc);
  TRY(send_frame(frame, deadline_ns));
  for (;; reply_.clear()) {
    while (reply_.empty()) TRY(take_more(deadline_ns));
    // Half a reply, or one to a request that was given up: the right one may still come.
    if (reply_.size() < reply_head_bytes + protocol::packet_crc_bytes) continue;
    const std::span<const std::byte> whole = reply_;
    const auto covered = whole.first(whole.size() - protocol::packet_crc_bytes);
    const auto sent = protocol::load_little<std::uint32_t>(whole.data() + covered.size());
    if (protocol::crc32c(covered) != sent || covered[0] != static_cast<std::byte>(request)) continue;
    const auto why = std::to_integer<int>(covered[1]);
    const auto data = covered.subspan(reply_head_bytes);
    const std::size_t bytes = std::min(data.size(), reply.size());
    std::copy_n(data.begin(), bytes, reply.begin());
    reply_.clear();
    if (why == 0) return bytes;
    return hal::fail(ErrorCode::io, description_.bus, "the device refused a request, error " + std::to_string(why));
  }
}

}  // namespace compueye::transport
